//! Scattering by fibres, with light from all directions: the twin of `fibre.wgsl`.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_appearance::fibre::arithmetic::acos;
use lovelock_appearance::fibre::{LOBES, PointLight, PointScatter};

use super::{LANES, Parts, ShadedFrom, part_of};
use crate::MAX_LIGHTS;
use crate::cpu::math::{log2, max};
use crate::cpu::view::{FibreView, View};
use crate::fibre::{
    FACING_FIBRES, FIBRES_PER_DEPTH, LEAST_COSINE, LEAST_TRANSMITTANCE, MAX_INCLINED, OWN_FIBRES,
};

/// The light that points scatter toward the eye, in `N` parts.
#[inline(always)]
pub(super) fn shade<const N: usize>(view: &View, fibre: &FibreView, from: &ShadedFrom) -> Parts<N> {
    let uniform = view.uniform;
    let ShadedFrom { here, tangent, to_eye, absorption, turn, packed, .. } = from;
    let (mut sin_v, mut cos_v) = (from.sin_v, from.cos_v);
    for lane in 0..LANES {
        sin_v[lane] = sin_v[lane].clamp(-MAX_INCLINED, MAX_INCLINED);
        cos_v[lane] = max(cos_v[lane], LEAST_COSINE);
    }
    let strength = uniform.many_scattering;
    let points = PointScatter::new(fibre.tables, &sin_v, &cos_v, absorption);
    let mut parts = [[[0.0; LANES]; 3]; N];
    for (k, light) in view.lights.iter().enumerate().take(MAX_LIGHTS) {
        // Roots lie on the skin: the bias prevents the skin under a strand from shadowing it.
        let shadow = light.past_body(here, None, 0.006, &view.strand_disc);
        let ([lx, ly, lz], arriving) = light.arriving(here);
        let none = [0.0; LANES];
        let mut at = PointLight { sin_theta: none, cos_theta: none, phi: none, fibres: none };
        for lane in 0..LANES {
            let (lx, ly, lz) = (lx[lane], ly[lane], lz[lane]);
            let sin = tangent[0][lane] * lx + tangent[1][lane] * ly + tangent[2][lane] * lz;
            let cos = max(1.0 - sin * sin, 0.0).sqrt();
            let lv = lx * to_eye[0][lane] + ly * to_eye[1][lane] + lz * to_eye[2][lane];
            // Where light or eye look along the strand there is no azimuth; any is as good.
            at.phi[lane] = acos((lv - sin * sin_v[lane]) / max(cos * cos_v[lane], 1e-4));
            let lit = (packed[lane] >> (8 * k) & 0xff) as f32 * (1.0 / 255.0);
            let crossed = -FIBRES_PER_DEPTH * std::f32::consts::LN_2 * log2(max(lit, LEAST_TRANSMITTANCE));
            let facing = max(lv, 0.0);
            at.fibres[lane] = max(crossed - OWN_FIBRES - FACING_FIBRES * facing * facing, 0.0);
            (at.sin_theta[lane], at.cos_theta[lane]) = (sin, cos);
        }
        let mut variances = [[0.0; LANES]; LOBES];
        for (variances, own) in variances.iter_mut().zip(fibre.lights[k].variances) {
            for lane in 0..LANES {
                variances[lane] = own + turn[lane];
            }
        }
        let found = points.radiance(fibre.tables, &variances, &at, strength);
        let radiance = light.radiance.to_array();
        let sum = &mut parts[part_of::<N>(Some(k))];
        for c in 0..3 {
            for lane in 0..LANES {
                sum[c][lane] += radiance[c] * (shadow[lane] * arriving[lane]) * found[c][lane];
            }
        }
    }
    let sum = &mut parts[part_of::<N>(None)];
    for lane in 0..LANES {
        let around = view.grid.at([here[0][lane], here[1][lane], here[2][lane]]);
        for c in 0..3 {
            sum[c][lane] += around[c] * points.albedo[c][lane];
        }
    }
    parts
}
