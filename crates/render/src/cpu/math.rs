//! Elementary functions without branches, so that loops that call them vectorise.
//!
//! They use only additions, products, roots and bit operations, no library functions and no fused products, so that every CPU and
//! every vector width gives the same bits. (Constants per frame, such as the tangent of the field of view, and the tables of fibre
//! scattering come from the system's library.)
// Inlined into the loops that `simd_versions!` compiles; a call would prevent vectorisation.
#![allow(clippy::inline_always)]

pub(super) use lovelock_appearance::fibre::arithmetic::{clamp, exp, exp2, floor, smoothstep, three};
pub(super) use lovelock_base::numbers::mix;

/// Adding this to a number below 2^22 rounds it to an integer, which is then in the lowest bits.
const ROUND: f32 = 12_582_912.0;

/// The minimum; `b` if either is NaN. One instruction, unlike `f32::min`.
#[inline(always)]
pub(super) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The maximum; `b` if either is NaN.
#[inline(always)]
pub(super) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The largest of numbers; any if one is NaN. By halves, which vectorises; a loop that keeps the largest so far does not.
#[inline(always)]
pub(super) fn most<const N: usize>(of: &[f32; N]) -> f32 {
    folded(of, max)
}

/// The smallest of numbers, like [`most`].
#[inline(always)]
pub(super) fn least<const N: usize>(of: &[f32; N]) -> f32 {
    folded(of, min)
}

#[inline(always)]
fn folded<const N: usize>(of: &[f32; N], two: impl Fn(f32, f32) -> f32) -> f32 {
    let mut left = *of;
    let mut count = N;
    while count > 1 {
        let half = count / 2;
        for i in 0..half {
            left[i] = two(left[i], left[i + half]);
        }
        // The last of an odd number.
        if count % 2 == 1 {
            left[0] = two(left[0], left[count - 1]);
        }
        count = half;
    }
    left[0]
}

/// `x` clamped to 0 and 1; 0 for NaN.
#[inline(always)]
pub(super) fn saturate(x: f32) -> f32 {
    clamp(x, 0.0, 1.0)
}

/// The integer `x` as an index, for `x` from 0 to 2^22, without a saturating conversion.
#[inline(always)]
pub(super) fn index_of(x: f32) -> u32 {
    (x + ROUND).to_bits() & 0x003f_ffff
}

/// Logarithm to base 2 of `x` above 1e-37; absolute error below 3e-7 near 1, relative below that elsewhere.
#[inline(always)]
pub(super) fn log2(x: f32) -> f32 {
    // The mantissa in 0.7071..1.4142, so that the logarithm of 1 is exactly 0.
    let bits = x.to_bits().wrapping_sub(0x3f35_04f3);
    let exponent = (bits as i32) >> 23;
    let m = f32::from_bits((bits & 0x007f_ffff).wrapping_add(0x3f35_04f3));
    let t = (m - 1.0) / (m + 1.0);
    let t2 = t * t;
    // 2/ln 2 times the series of artanh.
    let p = 0.412_198_6;
    let p = p * t2 + 0.577_078;
    let p = p * t2 + 0.961_796_7;
    let p = p * t2 + 2.885_39;
    exponent as f32 + t * p
}

/// `x` to the power of `y` for non-negative `x`; values below 1e-30 count as 1e-30.
#[inline(always)]
pub(super) fn pow(x: f32, y: f32) -> f32 {
    exp2(y * log2(max(x, 1e-30)))
}

/// Sine for `x` within ±1e4; absolute error below 2e-6 within ±200.
#[inline(always)]
pub(super) fn sin(x: f32) -> f32 {
    let turns = x * std::f32::consts::FRAC_1_PI;
    let shifted = turns + ROUND;
    // In two parts, so that the difference is exact.
    let n = shifted - ROUND;
    let r = (x - n * 3.140_625) - n * 9.676_535_9e-4;
    let r2 = r * r;
    let p = -2.388_985_9e-8;
    let p = p * r2 + 2.752_556_2e-6;
    let p = p * r2 - 1.984_087_5e-4;
    let p = p * r2 + 8.333_331e-3;
    let p = p * r2 - 0.166_666_67;
    let s = r + r * r2 * p;
    // An odd number of half turns changes the sign.
    f32::from_bits(s.to_bits() ^ (shifted.to_bits() << 31))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(from: f32, to: f32) -> impl Iterator<Item = f32> {
        (0..=100_000).map(move |i| from + (to - from) * i as f32 / 100_000.0)
    }

    #[test]
    fn exponential_and_logarithm_against_double_precision() {
        // Bounds are those of the comments above: a few units in the last place.
        for x in steps(-120.0, 120.0) {
            let truth = f64::from(x).exp2();
            assert!((f64::from(exp2(x)) / truth - 1.0).abs() < 3e-7, "2^{x}");
        }
        for x in steps(0.5, 2.0).chain(steps(1e-30, 1e-20)).chain(steps(1.0, 1e9)) {
            let truth = f64::from(x).log2();
            assert!((f64::from(log2(x)) - truth).abs() < 3e-7 * truth.abs().max(1.0), "log2 {x}");
        }
        assert_eq!(log2(1.0), 0.0);
        assert_eq!(exp2(0.0), 1.0);
        assert_eq!(exp2(3.0), 8.0);
    }

    #[test]
    fn powers() {
        for x in steps(0.0, 1.0) {
            for y in [0.7, 1.12, 2.2, 20.0, 80.0] {
                let truth = f64::from(x).powf(f64::from(y));
                // A power of 80 multiplies the logarithm's error by 80.
                assert!((f64::from(pow(x, y)) - truth).abs() < 2e-5 * truth.max(1e-3), "{x}^{y}");
            }
        }
        assert_eq!(pow(1.0, 80.0), 1.0);
    }

    #[test]
    fn sine() {
        for x in steps(-200.0, 200.0) {
            assert!((f64::from(sin(x)) - f64::from(x).sin()).abs() < 2e-6, "sin {x}");
        }
    }

    #[test]
    fn whole_numbers() {
        for x in [-3.5_f32, -1.0, -0.25, 0.0, 0.5, 1.0, 1.5, 2.5, 2.999_999_8, 4095.75, 1e6] {
            assert_eq!(floor(x), x.floor(), "floor {x}");
        }
        for x in [0.0, 1.0, 2.0, 511.0, 4_194_303.0] {
            assert_eq!(index_of(x), x as u32);
        }
        assert_eq!((min(f32::NAN, 2.0), max(f32::NAN, 2.0), saturate(f32::NAN)), (2.0, 2.0, 0.0));
    }

    #[test]
    fn the_largest_and_the_smallest_of_any_count() {
        let of = [3.0, -2.0, 7.5, 7.5, -9.0, 1.0, 0.0];
        assert_eq!((most(&of), least(&of)), (7.5, -9.0));
        for at in 0..7 {
            let mut of = [0.5; 7];
            of[at] = 2.0;
            assert_eq!((most(&of), least(&of)), (2.0, 0.5), "{at}");
        }
        assert_eq!((most(&[4.0]), least(&[4.0; 16])), (4.0, 4.0));
    }

    #[test]
    fn nothing_but_numbers_comes_out() {
        for x in [0.0, -1.0, f32::NAN, f32::INFINITY, f32::MIN_POSITIVE, f32::MAX] {
            assert!(pow(x, 1.12).is_finite() && exp2(x).is_finite() && exp(x).is_finite(), "{x}");
        }
    }
}
