//! The functions of depth whose means a record holds, and the moments that follow from them. Twin of means.wgsl.
//!
//! All functions lie between −1 and 1, so that their means keep their precision in integers. For power moments they are the Chebyshev
//! polynomials T₁(z) … T₂ₘ(z): their means determine the means of z … z²ᵐ, and an error in them makes no larger one in these. For
//! trigonometric moments they are cos kθ and sin kθ up to k = m, where θ is an angle proportional to z that leaves out a tenth of half
//! a turn, so that the ends do not meet (the wrapping zone of Münstermann and others 2018).
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]
// Indices as in the shader.
#![allow(clippy::needless_range_loop)]

use crate::methods::texels::turn::{turn, turn_on};

/// The angle θ of z = 1, in turns.
const LAST_TURN: f32 = 0.45;

/// The largest integer of 16 bits.
const MOST: f32 = 65_535.0;

/// The most means of a record.
pub(super) const MOST_MEANS: usize = 8;

/// Entries of a Hankel matrix, by the sum of row and column; its first 2m + 1 are used.
pub(super) type Hankel = [f32; MOST_MEANS + 1];

/// The share of even hair is mixed in with these power moments, which lie far from the border of what moments can be (Münstermann and
/// others 2018), for m = 2, 3 and 4.
const EVEN: [Hankel; 3] = [
    [1.0, 0.0, 0.375, 0.0, 0.375, 0.0, 0.0, 0.0, 0.0],
    [1.0, 0.0, 0.48, 0.0, 0.451, 0.0, 0.45, 0.0, 0.0],
    [1.0, 0.0, 0.75, 0.0, 0.676_666_7, 0.0, 0.63, 0.0, 0.600_303],
];

/// Calls `put` with the number and the value of each of `count` functions at `z`, −1 to 1.
pub(super) fn each_function(is_trigonometric: bool, count: usize, z: f32, mut put: impl FnMut(usize, f32)) {
    if is_trigonometric {
        let one = turn(z * LAST_TURN);
        let mut turned = one;
        for k in 0..count / 2 {
            put(2 * k, turned[0]);
            put(2 * k + 1, turned[1]);
            turned = turn_on(turned, one);
        }
        return;
    }
    let (mut before, mut value) = (1.0, z);
    for k in 0..count {
        put(k, value);
        (before, value) = (value, 2.0 * z * value - before);
    }
}

/// Sine and cosine of half of the angle of `z`.
#[inline(always)]
pub(super) fn half_turn(z: f32) -> [f32; 2] {
    let [cosine, sine] = turn(z * (0.5 * LAST_TURN));
    [sine, cosine]
}

/// The cosine of half of the angle at which the wrapping zone begins: cos 0.45 π.
pub(super) const WRAPPING: f32 = 0.156_434_46;

/// The means of z⁰ … z²ᴹ, with a share `bias` of even hair.
#[inline(always)]
pub(super) fn power_moments<const M: usize>(means: &[f32; MOST_MEANS], bias: f32) -> Hankel {
    let [t1, t2, t3, t4, t5, t6, t7, t8] = *means;
    let mut moments = [0.0; MOST_MEANS + 1];
    moments[..5].copy_from_slice(&[
        1.0,
        t1,
        0.5 + 0.5 * t2,
        0.75 * t1 + 0.25 * t3,
        0.375 + 0.5 * t2 + 0.125 * t4,
    ]);
    if M > 2 {
        moments[5] = (10.0 * t1 + 5.0 * t3 + t5) * (1.0 / 16.0);
        moments[6] = (10.0 + 15.0 * t2 + 6.0 * t4 + t6) * (1.0 / 32.0);
    }
    if M > 3 {
        moments[7] = (35.0 * t1 + 21.0 * t3 + 7.0 * t5 + t7) * (1.0 / 64.0);
        moments[8] = (35.0 + 56.0 * t2 + 28.0 * t4 + 8.0 * t6 + t8) * (1.0 / 128.0);
    }
    for k in 1..=2 * M {
        moments[k] += (EVEN[M - 2][k] - moments[k]) * bias;
    }
    moments
}

/// The mean products of the functions of [`half_waves`], row after row up to the diagonal, with a share `bias` of hair that is even on the
/// circle.
#[inline(always)]
pub(super) fn products<const M: usize>(means: &[f32; MOST_MEANS], bias: f32) -> [[f32; 5]; 5] {
    let rest = 1.0 - bias;
    let (mut cosines, mut sines) = ([1.0; 5], [0.0; 5]);
    for k in 0..M {
        (cosines[k + 1], sines[k + 1]) = (means[2 * k] * rest, means[2 * k + 1] * rest);
    }
    let mut products = [[0.0; 5]; 5];
    for row in 0..=M {
        for column in 0..=row {
            // Half of the difference and of the sum of both frequencies, as multiples of θ: those of a column are not below.
            let (difference, sum) = (row / 2 - column / 2, M - row / 2 - column / 2);
            products[row][column] = 0.5
                * match (row % 2, column % 2) {
                    (0, 0) => cosines[sum] + cosines[difference],
                    (1, 1) => cosines[difference] - cosines[sum],
                    (0, _) => sines[sum] + sines[difference],
                    _ => sines[sum] - sines[difference],
                };
        }
    }
    products
}

/// Cosine and sine of M, M − 2, … times half of an angle, of which `c` and `s` are cosine and sine; the last is 1 if M is even. The square
/// of these functions integrates to the same over the circle, so that systems of their products are as good as they can be.
#[inline(always)]
pub(super) fn half_waves<const M: usize>(s: f32, c: f32) -> [f32; 5] {
    let one = [c, s];
    let two = turn_on(one, one);
    match M {
        2 => [two[0], two[1], 1.0, 0.0, 0.0],
        3 => {
            let three = turn_on(two, one);
            [three[0], three[1], c, s, 0.0]
        }
        _ => {
            let four = turn_on(two, two);
            [four[0], four[1], two[0], two[1], 1.0]
        }
    }
}

/// A mean as an integer of 16 bits.
pub(super) fn to_short(mean: f32) -> u32 {
    ((mean * 0.5 + 0.5).clamp(0.0, 1.0) * MOST + 0.5) as u32
}

/// The mean of an integer of 16 bits.
#[inline(always)]
pub(super) fn from_short(bits: u32) -> f32 {
    bits as f32 * (2.0 / MOST) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The means of hair at depths with weights.
    fn means(is_trigonometric: bool, count: usize, hair: &[(f32, f32)]) -> [f32; MOST_MEANS] {
        let mut sums = [0.0; MOST_MEANS];
        for (z, weight) in hair {
            each_function(is_trigonometric, count, *z, |k, value| sums[k] += weight * value);
        }
        sums
    }

    /// The largest difference of the entries of both systems from their definition, of means as they are and in 16 bits.
    fn worst<const M: usize>(worst: &mut [f32; 2], hair: &[(f32, f32)]) {
        let mean = |value: &dyn Fn(f64) -> f64| {
            hair.iter().map(|(z, weight)| f64::from(*weight) * value(f64::from(*z))).sum::<f64>() as f32
        };
        let (powers, waves) = (means(false, 2 * M, hair), means(true, 2 * M, hair));
        for (worst, is_short) in worst.iter_mut().zip([false, true]) {
            let stored = |mean: f32| if is_short { from_short(to_short(mean)) } else { mean };
            let moments = power_moments::<M>(&powers.map(stored), 0.0);
            for k in 0..=2 * M {
                *worst = worst.max((moments[k] - mean(&|z| z.powi(k as i32))).abs());
            }
            let found = products::<M>(&waves.map(stored), 0.0);
            let wave = |k: usize, z: f64| {
                let half = z * 0.45 * std::f64::consts::PI;
                f64::from(half_waves::<M>(half.sin() as f32, half.cos() as f32)[k])
            };
            for row in 0..=M {
                for column in 0..=row {
                    let expected = mean(&|z| wave(row, z) * wave(column, z));
                    *worst = worst.max((found[row][column] - expected).abs());
                }
            }
        }
    }

    #[test]
    fn moments_are_those_of_their_definition_also_in_16_bits() {
        let mut largest = [0.0_f32; 2];
        for i in -20_i16..=20 {
            let hair = [(f32::from(i) * 0.05, 0.3), (0.9 - f32::from(i) * 0.005, 0.7)];
            worst::<2>(&mut largest, &hair);
            worst::<3>(&mut largest, &hair);
            worst::<4>(&mut largest, &hair);
        }
        println!("largest error {largest:?}");
        // Half a step of 16 bits is 1.5e-5; errors of two means may add up.
        assert!(largest[0] < 1e-6 && largest[1] < 2e-5 && largest[1] > 1e-6, "{largest:?}");
    }

    #[test]
    fn the_wrapping_zone_begins_at_the_last_depth() {
        let [sine, cosine] = half_turn(1.0);
        assert!((cosine - WRAPPING).abs() < 1e-6 && sine > 0.98);
        assert!((half_turn(-1.0)[1] - WRAPPING).abs() < 1e-6);
    }
}
