//! `e^(−τ)` in a form that vectorises and gives the same bits on every CPU.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::simd::whole_part;

/// Optical depth 1 in the 16-bit steps of a cell.
pub(crate) const DEPTH_STEPS: f32 = 4096.0;

/// `e^(−depth / 4096)` for `0 <= depth <= 65535`: exactly 1 at 0, relative error below 3e-7.
///
/// The exponent is split into an integer power of two and a remainder `g` in `0..1`; `2^(−g)` is a minimax polynomial of
/// degree 5 with the constant term fixed at 1. No fused operations, so that every CPU rounds alike.
#[inline(always)]
pub(crate) fn exp_of_minus_steps(depth: f32) -> f32 {
    let octaves = depth * (std::f32::consts::LOG2_E / DEPTH_STEPS);
    let whole = whole_part(octaves);
    let g = octaves - whole as f32;
    let p = -9.449_037e-4_f32;
    let p = p * g + 9.205_799e-3;
    let p = p * g + -5.529_736e-2;
    let p = p * g + 0.240_180_15;
    let p = p * g + -0.693_143_7;
    let p = p * g + 1.0;
    // Decreasing the exponent bits divides by 2^whole, which is at most 24 here, far from the smallest float.
    // A check for overflow would be a branch in loops of vectors.
    f32::from_bits(p.to_bits().wrapping_sub((whole as u32) << 23))
}

/// `e^(−depth)` for any optical depth: 1 at 0 and for NaN, 10⁻²⁸ from 64 on, always between 0 and 1.
#[inline(always)]
pub(crate) fn exp_of_minus(depth: f32) -> f32 {
    let depth = if depth > 0.0 { depth } else { 0.0 };
    let depth = if depth < 64.0 { depth } else { 64.0 };
    let t = exp_of_minus_steps(depth * DEPTH_STEPS);
    if t < 1.0 { t } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_double_precision_at_every_step() {
        let mut worst = 0.0_f64;
        for step in 0..=65_535 * 4 {
            let depth = step as f32 * 0.25;
            let truth = (-f64::from(depth) / f64::from(DEPTH_STEPS)).exp();
            worst = worst.max((f64::from(exp_of_minus_steps(depth)) / truth - 1.0).abs());
        }
        // Polynomial 0.9e-7, rounding of the polynomial 1.6e-7, and of `octaves` (up to 23) 24 · 2^-24 · ln 2.
        assert!(worst < 1.3e-6, "relative error {worst:e}");
    }

    #[test]
    fn every_depth_has_a_transmittance() {
        for depth in [0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(exp_of_minus(depth), 1.0);
        }
        for depth in [64.0, 1e30, f32::INFINITY] {
            assert!((0.0..1e-27).contains(&exp_of_minus(depth)));
        }
        let mut last = 1.0;
        for step in 1..10_000 {
            let depth = step as f32 * 0.004;
            let t = exp_of_minus(depth);
            let truth = (-f64::from(depth)).exp();
            // As above, with octaves up to 58 of 2^-24 each.
            assert!((f64::from(t) / truth - 1.0).abs() < 3e-6, "{depth}: {t}");
            assert!(t < last);
            last = t;
        }
    }

    #[test]
    fn no_depth_is_exactly_all_light() {
        assert_eq!(exp_of_minus_steps(0.0), 1.0);
        assert!(exp_of_minus_steps(1.0) < 1.0);
        assert!(exp_of_minus_steps(65_535.0) > 0.0);
    }
}
