//! Projects and shades every strand point once: the twin of `strand_points.wgsl` and `strand_shading.wgsl`.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use glam::Vec4;
use lovelock_groom::simd::Width;
use lovelock_groom::{Strands, simd_versions};
use rayon::prelude::*;

use super::math::{exp, exp2, floor, log2, max, mix, pow, saturate, smoothstep};
use super::view::View;
use crate::MAX_LIGHTS;

/// Points that are shaded together.
const LANES: usize = 16;
/// Points per task.
const PIECE: usize = 1024;

/// A shaded strand point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ShadedPoint {
    /// Pixels from the left and from the top.
    pub x: f32,
    /// See `x`.
    pub y: f32,
    /// 1 at the near plane, falling to 0 at infinity.
    pub depth: f32,
    /// Half of the width of the strand, pixels; negative if the point must not be drawn.
    pub half_width: f32,
    /// Unit vector along the strand on the screen.
    pub run_x: f32,
    /// See `run_x`.
    pub run_y: f32,
    /// Colour, linear.
    pub color: [f32; 3],
    /// A hash of the strand in 0..1.
    pub hash: f32,
}

/// The input of shading.
pub(super) struct PointsIn<'a> {
    pub strands: &'a Strands,
    /// See `pack_detail`.
    pub details: &'a [u32],
    /// Four 8-bit transmittances per point.
    pub transmittance: &'a [u32],
}

/// Shades all points, in parallel.
pub(super) fn shade_all(width: Width, view: &View, input: &PointsIn, out: &mut Vec<ShadedPoint>) {
    out.resize(out_of(input), ShadedPoint::default());
    out.par_chunks_mut(PIECE)
        .enumerate()
        .for_each(|(piece, out)| shade_points_simd(width, view, input, piece * PIECE, out));
}

type Lane = [f32; LANES];

/// The number of complete points: strands and hairstyle should have the same size, but surplus points are ignored.
fn out_of(input: &PointsIn) -> usize {
    let Strands { x, y, z, .. } = input.strands;
    x.len().min(y.len()).min(z.len()).min(input.details.len()).min(input.transmittance.len())
}

simd_versions! {
    /// [`shade_points`] for the vectors of `width`.
    fn shade_points_simd(view: &View, input: &PointsIn, first: usize, out: &mut [ShadedPoint]) -> () {
        shade_points(view, input, first, out)
    }
}

/// Shades the points from `first` on.
#[inline(always)]
fn shade_points(view: &View, input: &PointsIn, first: usize, out: &mut [ShadedPoint]) {
    for (group, out) in out.chunks_mut(LANES).enumerate() {
        shade_group(view, input, first + group * LANES, out);
    }
}

#[inline(always)]
fn shade_group(view: &View, input: &PointsIn, first: usize, out: &mut [ShadedPoint]) {
    let Strands { x, y, z, .. } = input.strands;
    let last = out_of(input) - 1;
    let mut here = [[0.0; LANES]; 3];
    let mut before = [[0.0; LANES]; 3];
    let mut after = [[0.0; LANES]; 3];
    let mut detail = [0_i32; LANES];
    let mut packed = [0_i32; LANES];
    for lane in 0..LANES {
        let i = (first + lane).min(last);
        let word = input.details[i];
        let (a, b) =
            (i.saturating_sub(1 - (word >> 24 & 1) as usize), (i + 1 - (word >> 25 & 1) as usize).min(last));
        detail[lane] = word as i32;
        packed[lane] = input.transmittance[i] as i32;
        for (axis, from) in [x, y, z].into_iter().enumerate() {
            here[axis][lane] = from[i];
            before[axis][lane] = from[a];
            after[axis][lane] = from[b];
        }
    }

    let uniform = view.uniform;
    let [clip_x, clip_y, _, clip_w] = rows(uniform.clip_from_world);
    let size = [uniform.size_scale_exposure.x, uniform.size_scale_exposure.y];
    let project = |p: &[Lane; 3]| {
        let mut to = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            let at = [p[0][lane], p[1][lane], p[2][lane]];
            let w = dot4(clip_w, at);
            let inverse = 1.0 / max(w, 1e-4);
            to[0][lane] = (dot4(clip_x, at) * inverse * 0.5 + 0.5) * size[0];
            to[1][lane] = (0.5 - dot4(clip_y, at) * inverse * 0.5) * size[1];
            to[2][lane] = w;
        }
        to
    };
    let (at, at_before, at_after) = (project(&here), project(&before), project(&after));

    // The direction of the strand on the screen and in space.
    let mut run = [[0.0; LANES]; 2];
    let mut tangent = [[0.0; LANES]; 3];
    let mut to_eye = [[0.0; LANES]; 3];
    let eye = uniform.eye_lights.to_array();
    for lane in 0..LANES {
        let (dx, dy) = (at_after[0][lane] - at_before[0][lane], at_after[1][lane] - at_before[1][lane]);
        let length = (dx * dx + dy * dy).sqrt();
        let inverse = if length > 1e-4 { 1.0 / length } else { 0.0 };
        run[0][lane] = dx * inverse;
        run[1][lane] = if length > 1e-4 { dy * inverse } else { 1.0 };
    }
    let mut tangent_squared = [0.0; LANES];
    let mut eye_squared = [0.0; LANES];
    for axis in 0..3 {
        for lane in 0..LANES {
            let (t, v) = (after[axis][lane] - before[axis][lane], eye[axis] - here[axis][lane]);
            tangent_squared[lane] += t * t;
            eye_squared[lane] += v * v;
            (tangent[axis][lane], to_eye[axis][lane]) = (t, v);
        }
    }
    for lane in 0..LANES {
        tangent_squared[lane] = 1.0 / max(tangent_squared[lane].sqrt(), 1e-9);
        eye_squared[lane] = 1.0 / max(eye_squared[lane].sqrt(), 1e-3);
    }
    for axis in 0..3 {
        for lane in 0..LANES {
            tangent[axis][lane] *= tangent_squared[lane];
            to_eye[axis][lane] *= eye_squared[lane];
        }
    }
    let mut sin_v = [0.0; LANES];
    let mut cos_v = [0.0; LANES];
    for lane in 0..LANES {
        sin_v[lane] = tangent[0][lane] * to_eye[0][lane]
            + tangent[1][lane] * to_eye[1][lane]
            + tangent[2][lane] * to_eye[2][lane];
        cos_v[lane] = max(1.0 - sin_v[lane] * sin_v[lane], 0.0).sqrt();
    }

    // The colours of the fibre: paths of many lengths through absorbing hair.
    let absorption = uniform.absorption_variation.to_array();
    let (tip_lightening, variation) = (uniform.width_opacity_tip_scalp.z, absorption[3]);
    let mut stretched = [0.0; LANES];
    for lane in 0..LANES {
        let along = (detail[lane] >> 8 & 0xff) as f32 * (1.0 / 255.0);
        let shade = (detail[lane] >> 16 & 0xff) as f32 * (1.0 / 255.0);
        let lightened = 1.0 - tip_lightening * smoothstep(0.2, 1.0, along);
        stretched[lane] = pow(max((1.0 + variation * (2.0 * shade - 1.0)) * lightened, 0.0), 0.7);
    }
    let mut body = [[0.0; LANES]; 3];
    let mut body_log = [[0.0; LANES]; 3];
    let mut second = [[0.0; LANES]; 3];
    let mut through = [[0.0; LANES]; 3];
    for c in 0..3 {
        let sigma = pow(max(absorption[c], 0.0), 0.7);
        for lane in 0..LANES {
            let s = sigma * stretched[lane];
            body[c][lane] = exp(-2.8 * s) + 0.012;
            body_log[c][lane] = log2(body[c][lane]);
            second[c][lane] = exp(-2.2 * s) + 0.02;
            through[c][lane] = exp(-1.7 * s) + 0.02;
        }
    }

    let mut sum = [[0.0; LANES]; 3];
    let mut open = [0.0; LANES];
    let [primary, secondary, primary_exponent, secondary_exponent] = uniform.highlights.to_array();
    for (k, light) in view.lights.iter().enumerate().take(MAX_LIGHTS) {
        // Roots lie on the skin: the bias prevents the skin under a strand from shadowing it.
        let shadow = light.body_light(&here, &[[0.0; LANES]; 3], 0.006, &view.strand_disc);
        let [lx, ly, lz] = (-light.direction).to_array();
        let (radiance, specular) = (light.radiance.to_array(), light.specular);
        let mut share = [0.0; LANES];
        let mut diffuse = [0.0; LANES];
        let mut depth = [0.0; LANES];
        let mut reflected = [0.0; LANES];
        let mut broad = [0.0; LANES];
        let mut passed = [0.0; LANES];
        for lane in 0..LANES {
            let lit = (packed[lane] >> (8 * k) & 0xff) as f32 * (1.0 / 255.0);
            open[lane] += lit.sqrt();
            share[lane] = lit * shadow[lane];
            // Light that has passed through other hair is more coloured with depth.
            depth[lane] = 1.0 + 0.45 * (1.0 - lit);
            let sin_l = tangent[0][lane] * lx + tangent[1][lane] * ly + tangent[2][lane] * lz;
            let cos_l = max(1.0 - sin_l * sin_l, 0.0).sqrt();
            let (sin_v, cos_v) = (sin_v[lane], cos_v[lane]);
            let cos_sum = cos_l * cos_v - sin_l * sin_v;
            let sin_sum = sin_l * cos_v + cos_l * sin_v;
            let shifted = pow(max(cos_sum * 0.992_81 - sin_sum * 0.119_71, 0.0), primary_exponent);
            let shifted_back = pow(max(cos_sum * 0.975_90 + sin_sum * 0.218_23, 0.0), secondary_exponent);
            let lv = lx * to_eye[0][lane] + ly * to_eye[1][lane] + lz * to_eye[2][lane];
            let azimuth = (lv - sin_l * sin_v) / max(cos_l * cos_v, 1e-3);
            let behind = saturate(0.5 - 0.5 * azimuth);
            let front = 0.35 + 0.65 * saturate(0.5 + 0.5 * azimuth);
            let straight = max(cos_sum, 0.0) * max(cos_sum, 0.0);
            diffuse[lane] = 0.32 * cos_l;
            reflected[lane] = specular * 0.13 * primary * shifted * front;
            broad[lane] = specular * 0.40 * secondary * shifted_back * front;
            passed[lane] = specular
                * 0.50
                * (behind * behind * behind)
                * (behind * behind * behind)
                * (straight * straight);
        }
        for c in 0..3 {
            let radiance = radiance[c];
            for lane in 0..LANES {
                let deep = exp2(body_log[c][lane] * depth[lane]);
                let shine = reflected[lane] + broad[lane] * second[c][lane] + passed[lane] * through[c][lane];
                sum[c][lane] += radiance * share[lane] * (diffuse[lane] * deep + shine);
            }
        }
    }

    // Ambient light reaches the inside through the same hair; a part of it always does.
    let ambient = view.ambient(0.3);
    let lights = view.lights.len();
    let each = if lights > 0 { 1.0 / lights as f32 } else { 0.0 };
    let closed = if lights > 0 { 0.0 } else { 1.0 };
    for c in 0..3 {
        let ambient = 0.5 * ambient[c];
        for lane in 0..LANES {
            sum[c][lane] += ambient * body[c][lane] * mix(0.22, 1.0, open[lane] * each + closed);
        }
    }
    let (scale, width) = (uniform.size_scale_exposure.z, uniform.width_opacity_tip_scalp.x);
    // The last of fine strands fade.
    let [fade_end, fade_slope, points_per_strand, _] = uniform.fading.to_array();
    let points_per_strand = max(points_per_strand, 1.0) as u32;
    let mut hash = [0.0; LANES];
    let mut half_width = [0.0; LANES];
    for lane in 0..LANES {
        let taper = (detail[lane] & 0xff) as f32 * (1.0 / 255.0);
        let shade = (detail[lane] >> 16 & 0xff) as f32 * (1.0 / 255.0);
        hash[lane] = shade * 37.0 - floor(shade * 37.0);
        let w = at[2][lane];
        let visible = (w > 0.02) & (at_before[2][lane] > 0.02) & (at_after[2][lane] > 0.02);
        let strand = (first + lane) as u32 / points_per_strand;
        let share = saturate((fade_end - strand as f32) * fade_slope);
        let wide = 0.5 * width * taper * share * scale / max(w, 1e-3);
        // A NaN point is not drawn: every comparison with it is false.
        let drawn = visible & (at[0][lane].abs() < 1e6) & (at[1][lane].abs() < 1e6) & (sum[0][lane] < 1e6);
        half_width[lane] = if drawn { wide } else { -1.0 };
    }
    for (lane, out) in out.iter_mut().enumerate() {
        *out = ShadedPoint {
            x: at[0][lane],
            y: at[1][lane],
            depth: crate::camera::NEAR_METRES / max(at[2][lane], 1e-4),
            half_width: half_width[lane],
            run_x: run[0][lane],
            run_y: run[1][lane],
            color: [sum[0][lane], sum[1][lane], sum[2][lane]],
            hash: hash[lane],
        };
    }
}

/// The rows of a matrix.
fn rows(m: glam::Mat4) -> [Vec4; 4] {
    [m.row(0), m.row(1), m.row(2), m.row(3)]
}

#[inline(always)]
fn dot4(row: Vec4, p: [f32; 3]) -> f32 {
    row.x * p[0] + row.y * p[1] + row.z * p[2] + row.w
}
