//! Elementary functions in plain single-precision arithmetic, which vectorise and which a shader can repeat.
// Inlined into the loops of a renderer; a call would prevent vectorisation.
#![allow(clippy::inline_always)]

/// 1.5 times 2^23: adding it to a number within ±2^22 rounds to an integer, which then is in the low bits.
const ROUND: f32 = 12_582_912.0;

/// `x` clamped to `low` and `high`; `low` for a value that is not a number. Two instructions, unlike `f32::clamp`.
#[inline(always)]
pub fn clamp(x: f32, low: f32, high: f32) -> f32 {
    let x = if x > low { x } else { low };
    if x < high { x } else { high }
}

/// Three numbers, one per channel. Unlike `map` of an array it is always inlined, which the loop around it needs to vectorise.
#[inline(always)]
pub fn three(of: impl Fn(usize) -> f32) -> [f32; 3] {
    [of(0), of(1), of(2)]
}

/// 0 below `low`, 1 above `high`, smooth between, as in WGSL.
#[inline(always)]
pub fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = clamp((x - low) / (high - low), 0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The floor of `x`, for `x` within ±2^22.
#[inline(always)]
pub fn floor(x: f32) -> f32 {
    let rounded = (x + ROUND) - ROUND;
    rounded - if rounded > x { 1.0 } else { 0.0 }
}

/// e to the power of `x`; relative error below 3e-7 for `x` from -80 to 88. Smaller arguments return at least 1e-38, so a product
/// of a few results is still a normal number or zero.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    exp2(x * std::f32::consts::LOG2_E)
}

/// 2 to the power of `x`, which is clamped to -126..127; relative error below 3e-7.
#[inline(always)]
pub fn exp2(x: f32) -> f32 {
    let x = clamp(x, -126.0, 127.0);
    let shifted = x + ROUND;
    let f = x - (shifted - ROUND);
    // Minimax on -0.5..0.5 (Remez, relative error 4e-8 before rounding).
    let p = 0.000_154_653_75;
    let p = p * f + 0.001_339_989_4;
    let p = p * f + 0.009_618_031;
    let p = p * f + 0.055_503_32;
    let p = p * f + 0.240_226_5;
    let p = p * f + std::f32::consts::LN_2;
    let p = p * f + 1.0;
    f32::from_bits(p.to_bits().wrapping_add(shifted.to_bits() << 23))
}

/// Angle in 0..pi whose cosine is `x`, within 7e-5 radians (Abramowitz and Stegun 4.4.45). `x` is clamped to -1..1.
#[inline(always)]
pub fn acos(x: f32) -> f32 {
    let a = x.abs().min(1.0);
    let p = -0.018_729_3;
    let p = p * a + 0.074_261;
    let p = p * a - 0.212_114_4;
    let p = p * a + 1.570_728_8;
    let angle = (1.0 - a).sqrt() * p;
    if x < 0.0 { std::f32::consts::PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::{acos, exp, floor, smoothstep};

    #[test]
    fn functions_against_double_precision() {
        for i in 0..=100_000 {
            let x = -80.0 + 168.0 * i as f32 / 100_000.0;
            // The multiplication with log2(e) rounds, which costs half a unit in the last place of x.
            let bound = 4e-7 + 7e-8 * f64::from(x.abs());
            assert!((f64::from(exp(x)) / f64::from(x).exp() - 1.0).abs() < bound, "{x}");
            let x = -1.0 + i as f32 / 50_000.0;
            assert!((f64::from(acos(x)) - f64::from(x).acos()).abs() < 7e-5, "{x}");
        }
        assert_eq!([-1.5, -1.0, 0.0, 0.7, 97.0, 97.4].map(floor), [-2.0, -1.0, 0.0, 0.0, 97.0, 97.0]);
        assert_eq!(
            [1.0, 2.0, 3.0, 4.0, f32::NAN].map(|x| smoothstep(2.0, 4.0, x)),
            [0.0, 0.0, 0.5, 1.0, 0.0]
        );
        assert_eq!(exp(0.0), 1.0);
        assert!(exp(-1e9) > 0.0 && exp(-1e9) < 2e-38 && exp(1e9).is_finite());
        assert!(acos(1.5).abs() < 1e-4 && (acos(-1.5) - std::f32::consts::PI).abs() < 1e-4);
    }
}
