//! Kajiya-Kay with two shifted highlights, light through the fibre and a colour that deepens inside hair: the twin of
//! `two_highlights.wgsl`.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_groom::HairLook;

use super::{LANES, Parts, ShadedFrom, part_of};
use crate::MAX_LIGHTS;
use crate::cpu::math::{exp, exp2, log2, max, mix, pow, saturate};
use crate::cpu::view::View;

/// The light that points reflect toward the eye, in `N` parts.
#[inline(always)]
pub(super) fn shade<const N: usize>(view: &View, from: &ShadedFrom) -> Parts<N> {
    let uniform = view.uniform;
    let ShadedFrom { here, tangent, to_eye, sin_v, cos_v, pigment, packed, .. } = from;
    // The colours of the fibre: paths of many lengths through absorbing hair.
    let absorption = uniform.absorption.to_array();
    let mut stretched = [0.0; LANES];
    for lane in 0..LANES {
        stretched[lane] = pow(pigment[lane], HairLook::STRETCH);
    }
    let mut body = [[0.0; LANES]; 3];
    let mut body_log = [[0.0; LANES]; 3];
    let mut second = [[0.0; LANES]; 3];
    let mut through = [[0.0; LANES]; 3];
    for c in 0..3 {
        let sigma = pow(max(absorption[c], 0.0), HairLook::STRETCH);
        for lane in 0..LANES {
            // The same for hair of the look's colour, whatever that of other hair.
            let own = from.absorption[c][lane];
            let is_own = from.has_colours & (own != absorption[c] * pigment[lane]);
            let s = if is_own { pow(max(own, 0.0), HairLook::STRETCH) } else { sigma * stretched[lane] };
            body[c][lane] = exp(-HairLook::BODY_PATH * s) + HairLook::SURFACE_SHARE;
            body_log[c][lane] = log2(body[c][lane]);
            second[c][lane] = exp(-4.1 * s) + 0.02;
            through[c][lane] = exp(-3.15 * s) + 0.02;
        }
    }

    let mut parts = [[[0.0; LANES]; 3]; N];
    let mut open = [0.0; LANES];
    let (primary, secondary) = (uniform.primary_strength, uniform.secondary_strength);
    for (k, light) in view.lights.iter().enumerate().take(MAX_LIGHTS) {
        // Roots lie on the skin: the bias prevents the skin under a strand from shadowing it.
        let shadow = light.past_body(here, None, 0.006, &view.strand_disc);
        let (toward, arriving) = light.arriving(here);
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
            share[lane] = lit * (shadow[lane] * arriving[lane]);
            // Light that has passed through other hair is more coloured with depth.
            depth[lane] = 1.0 + 0.45 * (1.0 - lit);
            let [lx, ly, lz] = [toward[0][lane], toward[1][lane], toward[2][lane]];
            let sin_l = tangent[0][lane] * lx + tangent[1][lane] * ly + tangent[2][lane] * lz;
            let cos_l = max(1.0 - sin_l * sin_l, 0.0).sqrt();
            let (sin_v, cos_v) = (sin_v[lane], cos_v[lane]);
            let cos_sum = cos_l * cos_v - sin_l * sin_v;
            let sin_sum = sin_l * cos_v + cos_l * sin_v;
            let shifted = pow(max(cos_sum * 0.992_81 - sin_sum * 0.119_71, 0.0), uniform.primary_exponent);
            let shifted_back =
                pow(max(cos_sum * 0.975_90 + sin_sum * 0.218_23, 0.0), uniform.secondary_exponent);
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
        let sum = &mut parts[part_of::<N>(Some(k))];
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
    let ambient = view.ambient([0.0, 0.3, 0.0]);
    let lights = view.lights.len();
    let each = if lights > 0 { 1.0 / lights as f32 } else { 0.0 };
    let closed = if lights > 0 { 0.0 } else { 1.0 };
    let sum = &mut parts[part_of::<N>(None)];
    for c in 0..3 {
        let ambient = ambient[c];
        for lane in 0..LANES {
            sum[c][lane] += ambient * body[c][lane] * mix(0.22, 1.0, open[lane] * each + closed);
        }
    }
    parts
}
