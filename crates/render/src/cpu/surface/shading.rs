//! Shading of the body, several pixels at a time: the twin of `surface_shading.wgsl`.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use lovelock_base::simd_versions;

use crate::cpu::math::{exp2, log2, max, mix, most, saturate, smoothstep, three};
use crate::cpu::view::View;

/// Height over the skin at which light from all directions is looked up, metres: hair that lies on skin shadows it.
const ABOVE_SKIN: f32 = 0.008;
/// How far light reaches around skin past its edge, as a cosine: red light travels furthest below the surface.
const WRAP: [f32; 3] = [0.12, 0.09, 0.07];
/// Positions that are shaded together.
pub(crate) const LANES: usize = 16;
type Lane = [f32; LANES];

/// Positions to shade, and the result.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceBatch {
    /// The number of positions in use.
    pub count: usize,
    /// The pixel of each position, and the fraction of the pixel that it fills.
    pub pixel: [usize; LANES],
    pub weight: Lane,
    pub position: [Lane; 3],
    pub normal: [Lane; 3],
    pub albedo: [Lane; 3],
    /// 1 where hair grows.
    pub scalp: Lane,
    /// Transmittance of hair toward each light.
    pub hair: [Lane; 4],
    /// The result, linear.
    pub color: [Lane; 3],
}

simd_versions! {
    /// [`shade_batch`] for the vectors of `width`.
    pub(crate) fn shade_batch_simd(view: &View, batch: &mut SurfaceBatch) -> () {
        shade_batch(view, batch)
    }
}

/// Ambient light that reaches the skin through the hair around it, looked up a little above the skin.
#[inline(always)]
pub(super) fn light_inside(
    view: &View,
    position: &[[f32; LANES]; 3],
    normal: &[[f32; LANES]; 3],
) -> [f32; LANES] {
    let mut inside = [0.0; LANES];
    for lane in 0..LANES {
        let at = three(|axis| position[axis][lane] + ABOVE_SKIN * normal[axis][lane]);
        inside[lane] = view.grid.at(at)[3];
    }
    inside
}

/// The colours of skin: under hair that of the roots, so that gaps do not look bald.
#[inline(always)]
pub(super) fn painted(view: &View, albedo: &[[f32; LANES]; 3], scalp: &[f32; LANES]) -> [[f32; LANES]; 3] {
    let mut paint = [0.0; LANES];
    for lane in 0..LANES {
        paint[lane] = 0.88 * smoothstep(0.15, 0.75, scalp[lane]);
    }
    let mut out = [[0.0; LANES]; 3];
    for c in 0..3 {
        for lane in 0..LANES {
            out[c][lane] = mix(albedo[c][lane], view.root[c], paint[lane]);
        }
    }
    out
}

/// Shades the positions of `batch`.
#[inline(always)]
fn shade_batch(view: &View, batch: &mut SurfaceBatch) {
    let uniform = view.uniform;
    let eye = uniform.eye.to_array();
    let albedo = painted(view, &batch.albedo, &batch.scalp);
    let mut toward_eye = [[0.0; LANES]; 3];
    let mut normal = [[0.0; LANES]; 3];
    let mut eye_length = [0.0; LANES];
    let mut normal_length = [0.0; LANES];
    for c in 0..3 {
        for lane in 0..LANES {
            let (v, n) = (eye[c] - batch.position[c][lane], batch.normal[c][lane]);
            eye_length[lane] += v * v;
            normal_length[lane] += n * n;
            (toward_eye[c][lane], normal[c][lane]) = (v, n);
        }
    }
    for lane in 0..LANES {
        eye_length[lane] = 1.0 / max(eye_length[lane].sqrt(), 1e-6);
        normal_length[lane] = 1.0 / max(normal_length[lane].sqrt(), 1e-6);
    }
    let mut facing_eye = [0.0; LANES];
    for c in 0..3 {
        for lane in 0..LANES {
            toward_eye[c][lane] *= eye_length[lane];
            normal[c][lane] *= normal_length[lane];
            facing_eye[lane] += toward_eye[c][lane] * normal[c][lane];
        }
    }
    let mut rim = [0.0; LANES];
    for lane in 0..LANES {
        let grazing = 1.0 - max(facing_eye[lane], 0.0);
        rim[lane] = 0.6 * (grazing * grazing) * (grazing * grazing);
    }

    let mut sum = [[0.0; LANES]; 3];
    for (light, hair) in view.lights.iter().zip(&batch.hair) {
        let (l, arriving) = light.arriving(&batch.position);
        let (radiance, specular) = (light.radiance.to_array(), light.specular);
        let mut facing = [0.0; LANES];
        let mut above = [0.0; LANES];
        for lane in 0..LANES {
            facing[lane] =
                normal[0][lane] * l[0][lane] + normal[1][lane] * l[1][lane] + normal[2][lane] * l[2][lane];
            // At grazing angles the flat triangles of a round limb shadow each other.
            above[lane] = 0.002 + 0.004 * (1.0 - saturate(facing[lane]));
        }
        // Light wraps a little around skin; the shadow map is looked up only where light can arrive.
        if most(&facing) <= -WRAP[0] {
            continue;
        }
        let mut place = [[0.0; LANES]; 3];
        for c in 0..3 {
            for lane in 0..LANES {
                place[c][lane] = batch.position[c][lane] + normal[c][lane] * above[lane];
            }
        }
        let lit = light.past_body(&place, Some(&normal), 0.003, view.body_disc(light));
        let mut shares = [0.0; LANES];
        let mut gloss = [0.0; LANES];
        for lane in 0..LANES {
            let [hx, hy, hz] = three(|c| l[c][lane] + toward_eye[c][lane]);
            let inverse = 1.0 / max((hx * hx + hy * hy + hz * hz).sqrt(), 1e-6);
            let nh = (normal[0][lane] * hx + normal[1][lane] * hy + normal[2][lane] * hz) * inverse;
            let shine = exp2(24.0 * log2(max(nh, 1e-12)));
            let share = lit[lane] * hair[lane] * arriving[lane];
            shares[lane] = share * 0.318;
            gloss[lane] = share
                * saturate(facing[lane])
                * (0.014 * (1.0 - batch.scalp[lane]) * specular * (shine + rim[lane]));
        }
        for c in 0..3 {
            let (radiance, wrap) = (radiance[c], WRAP[c]);
            for lane in 0..LANES {
                let matt = shares[lane] * saturate((facing[lane] + wrap) / (1.0 + wrap));
                sum[c][lane] += radiance * (albedo[c][lane] * matt + gloss[lane]);
            }
        }
    }

    let ambient = view.ambient_of(&normal);
    let inside = light_inside(view, &batch.position, &normal);
    for c in 0..3 {
        for lane in 0..LANES {
            batch.color[c][lane] = sum[c][lane] + ambient[c][lane] * albedo[c][lane] * inside[lane];
        }
    }
}
