//! Shading of surfaces with materials, several pixels at a time: the twin of `material_shading.wgsl`.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use super::reflectance::{bumped, fresnel, lobe, reflected_share, rim, spread, toon_ramp};
use super::shading::{LANES, light_inside, painted};
use crate::MAX_LIGHTS;
use crate::cpu::math::{max, mix, most, pow, saturate, three};
use crate::cpu::view::View;
use crate::surface_material::{LEAST_ROUGHNESS, SurfaceMaterial, TOON, UNLIT};

type Lane = [f32; LANES];

/// Positions to shade, and the result.
#[derive(Clone, Debug, Default)]
pub(crate) struct MaterialBatch {
    pub position: [Lane; 3],
    /// 1 where hair grows.
    pub scalp: Lane,
    /// Transmittance of hair toward each light.
    pub hair: [Lane; MAX_LIGHTS],
    /// The share of each light that passes the body: given if `is_past_body_known`, found otherwise.
    pub past_body: [Lane; MAX_LIGHTS],
    pub is_past_body_known: bool,
    pub normal: [Lane; 3],
    /// The normal with the bumps of the normal map; equal without one.
    pub bump: [Lane; 3],
    pub albedo: [Lane; 3],
    /// The colour in shade of a drawing.
    pub shade: [Lane; 3],
    pub emissive: [Lane; 3],
    pub occlusion: Lane,
    /// Numbers of [`SurfaceMaterial`].
    spread: [Lane; 3],
    reflectance: Lane,
    roughness: [Lane; 2],
    second: Lane,
    rim: Lane,
    shift: Lane,
    toony: Lane,
    rim_lift: Lane,
    rim_lit: Lane,
    rim_power: Lane,
    rim_color: [Lane; 3],
    /// 1 for what has highlights, and for drawings.
    has_gloss: Lane,
    is_toon: Lane,
    /// The result, linear.
    pub color: [Lane; 3],
}

impl MaterialBatch {
    /// Sets the numbers of the material of all positions, whose texture multiplies the roughness by `roughness`.
    #[inline(always)]
    pub fn set_material(&mut self, material: &SurfaceMaterial, roughness: &Lane) {
        for c in 0..3 {
            self.spread[c] = [material.spread[c]; LANES];
            self.rim_color[c] = [material.rim_color[c]; LANES];
        }
        self.reflectance = [material.reflectance; LANES];
        for k in 0..2 {
            for lane in 0..LANES {
                self.roughness[k][lane] = rough(material, k, roughness[lane]);
            }
        }
        self.second = [material.second; LANES];
        self.rim = [material.rim; LANES];
        (self.shift, self.toony) = ([material.shift; LANES], [material.toony; LANES]);
        (self.rim_lift, self.rim_lit) = ([material.rim_lift; LANES], [material.rim_lit; LANES]);
        self.rim_power = [material.rim_power; LANES];
        self.has_gloss = [if material.reflectance > 0.0 { 1.0 } else { 0.0 }; LANES];
        self.is_toon = [if material.model == TOON { 1.0 } else { 0.0 }; LANES];
        if material.model == UNLIT {
            // Nothing grows on what is seen as it is.
            self.scalp = [0.0; LANES];
        }
    }
}

/// The roughness of lobe `k` where a texture multiplies it.
#[inline(always)]
fn rough(material: &SurfaceMaterial, k: usize, by: f32) -> f32 {
    if material.is_rough_by_texture == 0 {
        return material.roughness[k];
    }
    max(material.roughness[k] * by, LEAST_ROUGHNESS)
}

/// Makes vectors as long as 1.
#[inline(always)]
fn normalize(v: &mut [Lane; 3]) {
    for lane in 0..LANES {
        let (x, y, z) = (v[0][lane], v[1][lane], v[2][lane]);
        let inverse = 1.0 / max((x * x + y * y + z * z).sqrt(), 1e-6);
        (v[0][lane], v[1][lane], v[2][lane]) = (x * inverse, y * inverse, z * inverse);
    }
}

#[inline(always)]
fn dot(a: &[Lane; 3], b: &[Lane; 3], lane: usize) -> f32 {
    a[0][lane] * b[0][lane] + a[1][lane] * b[1][lane] + a[2][lane] * b[2][lane]
}

/// Shades the positions of `batch`.
#[inline(always)]
pub(super) fn shade_materials(view: &View, batch: &mut MaterialBatch) {
    let uniform = view.uniform;
    batch.albedo = painted(view, &batch.albedo, &batch.scalp);
    let mut toward_eye = [[0.0; LANES]; 3];
    for (c, eye) in uniform.eye.to_array().into_iter().enumerate() {
        for lane in 0..LANES {
            toward_eye[c][lane] = eye - batch.position[c][lane];
        }
    }
    normalize(&mut toward_eye);
    normalize(&mut batch.normal);
    normalize(&mut batch.bump);
    let (normal, bump) = (batch.normal, batch.bump);
    // The cosine of the eye, the share of light that highlights reflect, and how much the rim of cloth replaces its colour.
    let (mut nv, mut glossy, mut rims) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        nv[lane] = max(dot(&bump, &toward_eye, lane), 1e-3);
        let (first, second) = (batch.roughness[0][lane], batch.roughness[1][lane]);
        let first = reflected_share(nv[lane], first, batch.reflectance[lane]);
        let second = reflected_share(nv[lane], second, batch.reflectance[lane]);
        let bare = batch.has_gloss[lane] * (1.0 - batch.scalp[lane]);
        glossy[lane] = bare * mix(first, second, batch.second[lane]);
        rims[lane] = rim(nv[lane], batch.rim[lane]);
    }
    let mut albedo = [[0.0; LANES]; 3];
    for c in 0..3 {
        for lane in 0..LANES {
            albedo[c][lane] = mix(batch.albedo[c][lane], max(batch.albedo[c][lane], 0.5), rims[lane]);
        }
    }

    // The rim of a drawing, and the light that multiplies it.
    let mut drawn_rim = [0.0; LANES];
    let has_rim = batch.rim_color.as_flattened().iter().any(|color| *color > 0.0);
    if has_rim {
        for lane in 0..LANES {
            let edge = saturate(1.0 - nv[lane] + batch.rim_lift[lane]);
            drawn_rim[lane] = batch.is_toon[lane] * pow(edge, batch.rim_power[lane]);
        }
    }
    let mut rim_light = [[0.0; LANES]; 3];
    let mut sum = [[0.0; LANES]; 3];
    if !batch.is_past_body_known {
        batch.past_body = [[0.0; LANES]; MAX_LIGHTS];
    }
    for (k, (light, hair)) in view.lights.iter().zip(&batch.hair).enumerate() {
        let (l, arriving) = light.arriving(&batch.position);
        let (radiance, specular) = (light.radiance.to_array(), light.specular);
        let (mut facing, mut cosine, mut above) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut reached = [0.0; LANES];
        for lane in 0..LANES {
            facing[lane] = dot(&normal, &l, lane);
            cosine[lane] = bumped(facing[lane], dot(&bump, &l, lane));
            above[lane] = 0.002 + 0.004 * (1.0 - saturate(facing[lane]));
            reached[lane] = facing[lane] + max(batch.spread[0][lane], 2.0 * batch.is_toon[lane]);
        }
        if most(&reached) <= 0.0 {
            continue;
        }
        let mut place = [[0.0; LANES]; 3];
        for c in 0..3 {
            for lane in 0..LANES {
                place[c][lane] = batch.position[c][lane] + normal[c][lane] * above[lane];
            }
        }
        if !batch.is_past_body_known {
            batch.past_body[k] = light.past_body(&place, Some(&normal), 0.003, view.body_disc(light));
        }
        let lit = &batch.past_body[k];
        let (mut arrived, mut gloss, mut ramp) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut passed = [0.0; LANES];
        for lane in 0..LANES {
            let [hx, hy, hz] = three(|c| l[c][lane] + toward_eye[c][lane]);
            let inverse = 1.0 / max((hx * hx + hy * hy + hz * hz).sqrt(), 1e-6);
            let nh = saturate((bump[0][lane] * hx + bump[1][lane] * hy + bump[2][lane] * hz) * inverse);
            let lh = (l[0][lane] * hx + l[1][lane] * hy + l[2][lane] * hz) * inverse;
            let nl = max(cosine[lane], 0.0);
            let first = lobe(nh, nl, nv[lane], batch.roughness[0][lane]);
            let second = lobe(nh, nl, nv[lane], batch.roughness[1][lane]);
            let through = lit[lane] * hair[lane];
            passed[lane] = through;
            arrived[lane] = arriving[lane] * 0.318;
            gloss[lane] = arriving[lane]
                * through
                * (batch.has_gloss[lane] * (1.0 - batch.scalp[lane]) * specular * nl)
                * (fresnel(batch.reflectance[lane], lh) * mix(first, second, batch.second[lane]));
            ramp[lane] = through * toon_ramp(cosine[lane], batch.shift[lane], batch.toony[lane]);
            // Light that reaches a lit surface: the shadow is part of the ramp of a drawing.
            arrived[lane] *= mix(through * (1.0 - glossy[lane]), 1.0, batch.is_toon[lane]);
        }
        // Only the first light shows the colour in shade, as in other viewers.
        let shaded = if k == 0 { 1.0 } else { 0.0 };
        for c in 0..3 {
            for lane in 0..LANES {
                let drawn = mix(shaded * batch.shade[c][lane], albedo[c][lane], ramp[lane]);
                let matt = albedo[c][lane] * spread(cosine[lane], batch.spread[c][lane]);
                let diffuse = mix(matt, drawn, batch.is_toon[lane]);
                sum[c][lane] += radiance[c] * (arrived[lane] * diffuse + gloss[lane]);
            }
        }
        if has_rim {
            for c in 0..3 {
                for lane in 0..LANES {
                    rim_light[c][lane] += radiance[c] * (arrived[lane] * passed[lane]);
                }
            }
        }
    }

    let even = view.ambient_mean();
    let mut mirror = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let twice = 2.0 * dot(&bump, &toward_eye, lane);
        for c in 0..3 {
            mirror[c][lane] = twice * bump[c][lane] - toward_eye[c][lane];
        }
    }
    let (ambient, mirrored) = (view.ambient_of(&bump), view.ambient_of(&mirror));
    let inside = light_inside(view, &batch.position, &normal);
    for c in 0..3 {
        for lane in 0..LANES {
            let inside = inside[lane] * batch.occlusion[lane];
            let around = mix(ambient[c][lane], even[c], batch.is_toon[lane]);
            let matt = around * albedo[c][lane] * (1.0 - glossy[lane]);
            let rim_light = rim_light[c][lane] + even[c] * inside;
            let drawn = drawn_rim[lane] * batch.rim_color[c][lane] * mix(1.0, rim_light, batch.rim_lit[lane]);
            batch.color[c][lane] = sum[c][lane]
                + (matt + mirrored[c][lane] * glossy[lane]) * inside
                + batch.emissive[c][lane]
                + drawn;
        }
    }
}
