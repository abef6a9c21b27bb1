//! The functions of depth whose means a record holds, and the moments that follow from them. Twin of means.wgsl.
//!
//! All functions lie between −1 and 1, so that their means keep their precision in integers. For power moments they are the Chebyshev
//! polynomials T₁(z) … T₂ₘ(z): their means determine the means of z … z²ᵐ, and an error in them grows in none of these. For
//! trigonometric moments they are cos kθ and sin kθ up to k = m, where θ is an angle proportional to z that leaves out a tenth of half
//! a turn, so that the ends do not meet (the wrapping zone of Münstermann and others 2018).
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use crate::methods::texels::turn::{turn, turn_on};

/// The angle θ of z = 1, in turns.
const LAST_TURN: f32 = 0.45;

/// The largest integer of 16 bits.
const MOST: f32 = 65_535.0;

/// The most means of a record.
pub(super) const MOST_MEANS: usize = 8;

/// Entries of a Hankel matrix, by the sum of row and column; its first 2m + 1 are used.
pub(super) type Hankel = [f32; 2 * MOST_MEANS / 2 + 1];

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

/// Half of the angle of `z`: its sine and cosine. The ratio of both is the coordinate in which trigonometric moments are power moments.
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
    // Means of zʲ times Tₖ; z Tₖ is the mean of the polynomials before and behind.
    let mut row = [1.0; MOST_MEANS + 1];
    row[1..].copy_from_slice(means);
    let mut moments = [1.0; MOST_MEANS + 1];
    for j in 1..=2 * M {
        let mut before = row[1];
        for k in 0..=2 * M - j {
            let value = 0.5 * (row[k + 1] + before);
            before = row[k];
            row[k] = value;
        }
        moments[j] = row[0] + (EVEN[M - 2][j] - row[0]) * bias;
    }
    moments
}

/// The means of sinᵏ cos²ᴹ⁻ᵏ of half of the angle, with a share `bias` of hair that is even on the circle.
///
/// They are power moments of the tangent, of a distribution in which hair counts by cos²ᴹ.
#[inline(always)]
pub(super) fn turned_moments<const M: usize>(means: &[f32; MOST_MEANS], bias: f32) -> Hankel {
    let rest = 1.0 - bias;
    // Means of cos kθ and sin kθ times the square of the cosine of half of the angle to the power j, the first of which are `even`
    // and, times sine and cosine of half of it, `odd`.
    let (mut cosines, mut sines) = ([0.0; 6], [0.0; 6]);
    cosines[0] = 1.0;
    for k in 0..M {
        (cosines[k + 1], sines[k + 1]) = (means[2 * k] * rest, means[2 * k + 1] * rest);
    }
    let (mut even, mut odd) = ([1.0; 5], [0.0; 5]);
    for j in 0..M {
        odd[j] = 0.5 * sines[1];
        let mut before = [cosines[1], 0.0];
        for k in 0..M - j {
            let value = [
                0.5 * cosines[k] + 0.25 * (cosines[k + 1] + before[0]),
                0.5 * sines[k] + 0.25 * (sines[k + 1] + before[1]),
            ];
            before = [cosines[k], sines[k]];
            // The sine of 0 stays 0.
            (cosines[k], sines[k]) = (value[0], if k == 0 { 0.0 } else { value[1] });
        }
        even[j + 1] = cosines[0];
    }
    // sin² = 1 − cos².
    let mut moments = [0.0; MOST_MEANS + 1];
    for j in 0..M {
        (moments[2 * j], moments[2 * j + 1]) = (even[M - j], odd[M - 1 - j]);
        for i in 0..M - j {
            even[i] -= even[i + 1];
            odd[i] -= odd[i + 1];
        }
    }
    moments[2 * M] = even[0];
    moments
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

    fn hankel(is_trigonometric: bool, m: usize, means: &[f32; MOST_MEANS]) -> Hankel {
        match (is_trigonometric, m) {
            (false, 2) => power_moments::<2>(means, 0.0),
            (false, 3) => power_moments::<3>(means, 0.0),
            (false, _) => power_moments::<4>(means, 0.0),
            (true, 2) => turned_moments::<2>(means, 0.0),
            (true, 3) => turned_moments::<3>(means, 0.0),
            (true, _) => turned_moments::<4>(means, 0.0),
        }
    }

    #[test]
    fn moments_are_those_of_their_definition_also_in_16_bits() {
        let mut worst = [0.0_f32; 2];
        for (is_trigonometric, m) in [false, true].into_iter().flat_map(|kind| [2, 3, 4].map(|m| (kind, m))) {
            for i in -20_i16..=20 {
                let hair = [(f32::from(i) * 0.05, 0.3), (0.9 - f32::from(i) * 0.005, 0.7)];
                let means = means(is_trigonometric, 2 * m, &hair);
                let short = means.map(|mean| from_short(to_short(mean)));
                let found = [means, short].map(|means| hankel(is_trigonometric, m, &means));
                for k in 0..=2 * m {
                    let expected: f64 = hair
                        .iter()
                        .map(|(z, weight)| {
                            let half = f64::from(*z) * 0.45 * std::f64::consts::PI;
                            let value = if is_trigonometric {
                                half.sin().powi(k as i32) * half.cos().powi((2 * m - k) as i32)
                            } else {
                                f64::from(*z).powi(k as i32)
                            };
                            f64::from(*weight) * value
                        })
                        .sum();
                    for (worst, found) in worst.iter_mut().zip(&found) {
                        *worst = worst.max((f64::from(found[k]) - expected).abs() as f32);
                    }
                }
            }
        }
        println!("largest error {worst:?}");
        // Half a step of 16 bits is 1.5e-5; errors of several means may add up.
        assert!(worst[0] < 1e-6 && worst[1] < 4e-5 && worst[1] > 1e-6, "{worst:?}");
    }

    #[test]
    fn the_wrapping_zone_begins_at_the_last_depth() {
        let [sine, cosine] = half_turn(1.0);
        assert!((cosine - WRAPPING).abs() < 1e-6 && sine > 0.98);
        assert!((half_turn(-1.0)[1] - WRAPPING).abs() < 1e-6);
    }
}
