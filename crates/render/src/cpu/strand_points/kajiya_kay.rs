//! Kajiya-Kay as published, with the composition of Bertails and others 2005, section 3.3: the twin of `kajiya_kay.wgsl`.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use std::f32::consts::FRAC_1_PI;

use lovelock_groom::HairLook;

use super::{LANES, Parts, ShadedFrom, part_of};
use crate::MAX_LIGHTS;
use crate::cpu::math::{exp, max, pow};
use crate::cpu::view::View;

/// The light that points reflect toward the eye, in `N` parts.
#[inline(always)]
pub(super) fn shade<const N: usize>(view: &View, from: &ShadedFrom) -> Parts<N> {
    let uniform = view.uniform;
    let ShadedFrom { here, tangent, sin_v, cos_v, absorption, packed, .. } = from;
    // The colour of the hair, and light from all directions, which hair does not shadow.
    let ambient = view.ambient_mean();
    let mut color = [[0.0; LANES]; 3];
    let mut parts = [[[0.0; LANES]; 3]; N];
    let sum = &mut parts[part_of::<N>(None)];
    for c in 0..3 {
        for lane in 0..LANES {
            let stretched = pow(max(absorption[c][lane], 0.0), HairLook::STRETCH);
            color[c][lane] = exp(-HairLook::BODY_PATH * stretched) + HairLook::SURFACE_SHARE;
            sum[c][lane] = ambient[c] * color[c][lane];
        }
    }
    for (k, light) in view.lights.iter().enumerate().take(MAX_LIGHTS) {
        // Roots lie on the skin: the bias prevents the skin under a strand from shadowing it.
        let shadow = light.past_body(here, None, 0.006, &view.strand_disc);
        let (toward, arriving) = light.arriving(here);
        let strength = light.specular * uniform.primary_strength;
        let mut matt = [0.0; LANES];
        let mut shine = [0.0; LANES];
        for lane in 0..LANES {
            let [lx, ly, lz] = [toward[0][lane], toward[1][lane], toward[2][lane]];
            let shadow = shadow[lane] * arriving[lane];
            let lit = (packed[lane] >> (8 * k) & 0xff) as f32 * (1.0 / 255.0) * shadow;
            let along = tangent[0][lane] * lx + tangent[1][lane] * ly + tangent[2][lane] * lz;
            let across = max(1.0 - along * along, 0.0).sqrt();
            let mirrored = max(across * cos_v[lane] - along * sin_v[lane], 0.0);
            matt[lane] = FRAC_1_PI * lit * across;
            shine[lane] = FRAC_1_PI * lit * strength * pow(mirrored, uniform.primary_exponent);
        }
        let radiance = light.radiance.to_array();
        let sum = &mut parts[part_of::<N>(Some(k))];
        for c in 0..3 {
            for lane in 0..LANES {
                sum[c][lane] += radiance[c] * (matt[lane] * color[c][lane] + shine[lane]);
            }
        }
    }
    parts
}
