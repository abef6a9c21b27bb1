//! From moments to the share of hair before a depth. Twin of solve.wgsl.
//!
//! Of all distributions with the same 2M moments, exactly one has hair at a given depth and at only M others. The hair of that one
//! before the depth is the least that can be there, and with the depth's own hair it is the most (Münstermann and others 2018, section 3).
//! Its depths are z and the roots of K(x, z) = v(x)ᵀ H⁻¹ v(z), where v(x) holds the powers of x and H is the Hankel matrix of the
//! moments; the hair at each of them is 1 / K(x, x).
//!
//! Depths are points s : c of a line, x = s / c. For trigonometric moments s and c are sine and cosine of half of an angle φ, and v(φ) holds
//! the functions of [`half_waves`], whose mean products are H: the same equations hold, because v consists of polynomials of degree M in s
//! and c there, too. The published solution has complex numbers instead.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]
// Indices as in the shader.
#![allow(clippy::needless_range_loop)]

use super::means::{MOST_MEANS, WRAPPING, half_turn, half_waves, power_moments, products};
use super::roots::real_roots;

/// The least pivot with which the system counts as solvable.
const LEAST_PIVOT: f32 = 1e-12;

/// The Cholesky factors of the matrix of a record with M + 1 rows, H = L D Lᵀ. `TURNED` for trigonometric moments.
#[derive(Clone, Copy, Debug)]
pub(super) struct System<const M: usize, const TURNED: bool> {
    /// L below its diagonal.
    l: [[f32; 5]; 5],
    /// The inverse of D.
    inverse: [f32; 5],
    is_solvable: bool,
}

impl<const M: usize, const TURNED: bool> System<M, TURNED> {
    /// The system of the means of a record; see [`super::means`].
    #[inline(always)]
    pub(super) fn new(means: &[f32; MOST_MEANS], bias: f32) -> Self {
        let mut l = [[0.0; 5]; 5];
        if TURNED {
            l = products::<M>(means, bias);
        } else {
            let moments = power_moments::<M>(means, bias);
            for row in 0..=M {
                l[row][..=row].copy_from_slice(&moments[row..=2 * row]);
            }
        }
        let (mut inverse, mut is_solvable) = ([0.0; 5], true);
        // Loops of one length for all rows, so that the compiler unrolls them.
        for row in 0..=M {
            // Until the end of the row, L times D.
            for column in 0..M {
                if column < row {
                    let mut entry = l[row][column];
                    for k in 0..M {
                        if k < column {
                            entry -= l[row][k] * l[column][k];
                        }
                    }
                    l[row][column] = entry;
                }
            }
            let mut pivot = l[row][row];
            for k in 0..M {
                if k < row {
                    let entry = l[row][k] * inverse[k];
                    pivot -= entry * l[row][k];
                    l[row][k] = entry;
                }
            }
            is_solvable &= pivot > LEAST_PIVOT;
            inverse[row] = 1.0 / pivot;
        }
        Self { l, inverse, is_solvable }
    }

    /// Whether the matrix is positive definite. Rounding and a small bias may make it indefinite: then no distribution has these
    /// moments. False for NaN.
    #[inline(always)]
    pub(super) fn is_solvable(&self) -> bool {
        self.is_solvable
    }

    /// The share of hair before `z`, of which a point's own depth counts by `overestimation`. Only of a solvable system.
    #[inline(always)]
    pub(super) fn share_before(&self, z: f32, overestimation: f32) -> f32 {
        let [s, c] = if TURNED { half_turn(z) } else { [z, 1.0] };
        let reduced = self.reduced(s, c);
        let own = self.weight(&reduced);
        // The coefficients of K, and then those of the polynomial whose root t stands for the depth t s + u : t c + v.
        let mut k = [0.0; 5];
        for row in (0..=M).rev() {
            let mut entry = reduced[row] * self.inverse[row];
            for below in 1..=M {
                if below > row {
                    entry -= self.l[below][row] * k[below];
                }
            }
            k[row] = entry;
        }
        let [u, v] = if TURNED { [c, -s] } else { [1.0, 0.0] };
        let a = if TURNED { rotated::<M>(&k, s, c, own) } else { shifted::<M>(&k, z, own) };
        let (mut all, mut before) = (own, own * overestimation);
        for t in &real_roots::<M>(&a)[..M] {
            let (s, c) = (t * s + u, t * c + v);
            let (weight, part) = if TURNED {
                let length = 1.0 / (s * s + c * c).sqrt();
                let (s, c) = (s * length, c * length);
                (self.weight(&self.reduced(s, c)), before_at(s, c))
            } else {
                // Hair infinitely far away has no weight.
                let near = if c.abs() < 1e-6 { 1e-6 } else { c };
                (self.weight(&self.reduced(s / near, 1.0)), if c < 0.0 { 1.0 } else { 0.0 })
            };
            all += weight;
            before += weight * part;
        }
        before / all
    }

    /// L⁻¹ v of a depth.
    #[inline(always)]
    fn reduced(&self, s: f32, c: f32) -> [f32; 5] {
        let mut entries = [1.0; 5];
        if TURNED {
            entries = half_waves::<M>(s, c);
        } else {
            for k in 1..=M {
                entries[k] = entries[k - 1] * s;
            }
        }
        for row in 1..=M {
            for column in 0..M {
                if column < row {
                    entries[row] -= self.l[row][column] * entries[column];
                }
            }
        }
        entries
    }

    /// 1 / K(x, x) of L⁻¹ v(x).
    #[inline(always)]
    fn weight(&self, reduced: &[f32; 5]) -> f32 {
        let mut sum = 0.0;
        for (entry, inverse) in reduced[..=M].iter().zip(&self.inverse) {
            sum += entry * entry * inverse;
        }
        1.0 / sum
    }
}

/// The coefficients of K(z + 1/t) tᴹ / K(z), from t⁰'s place downward: 1, a₁, …, with `own` = 1 / K(z).
#[inline(always)]
fn shifted<const M: usize>(k: &[f32; 5], z: f32, own: f32) -> [f32; 5] {
    let mut a = *k;
    for first in 0..M {
        for at in (0..M).rev() {
            if at >= first {
                a[at] += a[at + 1] * z;
            }
        }
    }
    a.map(|entry| entry * own)
}

/// The same for trigonometric moments, with t the cotangent of the half angle from z on: t s + c : t c − s.
#[inline(always)]
fn rotated<const M: usize>(k: &[f32; 5], s: f32, c: f32, own: f32) -> [f32; 5] {
    // K(z + δ) by the functions of δ: each pair turns by its multiple of the half angle of z.
    let turn = half_waves::<M>(s, c);
    let mut w = *k;
    for at in [0, 2] {
        if at < M {
            w[at] = k[at] * turn[at] + k[at + 1] * turn[at + 1];
            w[at + 1] = k[at + 1] * turn[at] - k[at] * turn[at + 1];
        }
    }
    // cos 4δ = c⁴ − 6 c² s² + s⁴ and so on, divided by sᴹ; lower multiples times powers of c² + s².
    let a = match M {
        2 => [w[0] + w[2], 2.0 * w[1], w[2] - w[0], 0.0, 0.0],
        3 => [w[0] + w[2], 3.0 * w[1] + w[3], w[2] - 3.0 * w[0], w[3] - w[1], 0.0],
        _ => [
            w[0] + w[2] + w[4],
            4.0 * w[1] + 2.0 * w[3],
            2.0 * w[4] - 6.0 * w[0],
            2.0 * w[3] - 4.0 * w[1],
            w[0] - w[2] + w[4],
        ],
    };
    a.map(|entry| entry * own)
}

/// How much hair of a depth counts as before another one: 1 or 0, by its side of it, and a part in the wrapping zone.
#[inline(always)]
fn before_at(s: f32, c: f32) -> f32 {
    if c.abs() < WRAPPING {
        let from_far_end = if s < 0.0 { -c } else { c };
        0.5 - 0.5 * from_far_end / WRAPPING
    } else if c < 0.0 {
        1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::means::each_function;
    use super::*;

    /// The means of hair at depths with weights that add up to 1.
    fn means(is_trigonometric: bool, m: usize, hair: &[(f32, f32)]) -> [f32; MOST_MEANS] {
        let mut sums = [0.0_f64; MOST_MEANS];
        for (z, weight) in hair {
            each_function(is_trigonometric, 2 * m, *z, |k, value| {
                sums[k] += f64::from(*weight) * f64::from(value);
            });
        }
        sums.map(|sum| sum as f32)
    }

    /// The share before `z`; `None` if no distribution has the moments.
    fn share<const M: usize>(
        is_trigonometric: bool,
        means: &[f32; MOST_MEANS],
        bias: f32,
        (z, own): (f32, f32),
    ) -> Option<f32> {
        if is_trigonometric {
            let system = System::<M, true>::new(means, bias);
            return system.is_solvable().then(|| system.share_before(z, own));
        }
        let system = System::<M, false>::new(means, bias);
        system.is_solvable().then(|| system.share_before(z, own))
    }

    /// [`share`] for all kinds: whether they are trigonometric, M, and the share.
    fn shares(hair: &[(f32, f32)], bias: f32, at: (f32, f32)) -> Vec<(bool, usize, Option<f32>)> {
        let of = |is_trigonometric: bool| {
            let means = |m| means(is_trigonometric, m, hair);
            [
                (is_trigonometric, 2, share::<2>(is_trigonometric, &means(2), bias, at)),
                (is_trigonometric, 3, share::<3>(is_trigonometric, &means(3), bias, at)),
                (is_trigonometric, 4, share::<4>(is_trigonometric, &means(4), bias, at)),
            ]
        };
        [false, true].into_iter().flat_map(of).collect()
    }

    /// Hair at M + 1 depths is the only distribution with its moments that has hair at one of them.
    #[test]
    fn one_card_more_than_half_of_the_moments_are_told_apart() {
        let cards = [(-0.9_f32, 0.2), (-0.4, 0.1), (0.05, 0.3), (0.5, 0.15), (0.85, 0.25)];
        let mut worst = 0.0_f32;
        for m in [2, 3, 4] {
            let hair = &cards[..=m];
            let all: f32 = hair.iter().map(|card| card.1).sum();
            let hair: Vec<_> = hair.iter().map(|(z, weight)| (*z, weight / all)).collect();
            for (at, (z, weight)) in hair.iter().enumerate() {
                let before: f32 = hair[..at].iter().map(|card| card.1).sum();
                for (is_trigonometric, of, found) in shares(&hair, 1e-6, (*z, 0.25)) {
                    if of == m {
                        let error = (found.expect("solvable") - (before + 0.25 * weight)).abs();
                        assert!(error < 1e-4, "{m}, {is_trigonometric}: {found:?} at {z}");
                        worst = worst.max(error);
                    }
                }
            }
        }
        println!("largest error {worst}");
    }

    /// Near hair, one root is a thousand times as large as the others.
    #[test]
    fn two_cards_at_the_ends_are_halves_next_to_them() {
        let cards = [(-1.0, 0.5), (1.0, 0.5)];
        let mut worst = 0.0_f32;
        for z in [-0.99, -0.9, -0.5, 0.2, 0.9, 0.99] {
            for (is_trigonometric, m, found) in shares(&cards, 5e-6, (z, 0.25)) {
                // Four moments leave a choice so near to a card.
                if m == 2 && z.abs() > 0.9 {
                    continue;
                }
                let error = (found.expect("solvable") - 0.5).abs();
                assert!(error < 0.03, "{m}, {is_trigonometric}: {found:?} at {z}");
                worst = worst.max(error);
            }
        }
        println!("largest error {worst}");
    }

    #[test]
    fn bounds_hold_the_truth_between_them_and_more_moments_bring_them_together() {
        let even: Vec<_> =
            (0..2000_u16).map(|i| ((f32::from(i) + 0.5) / 1000.0 - 1.0, 1.0 / 2000.0)).collect();
        for i in -9_i16..=9 {
            let z = f32::from(i) * 0.1;
            let truth = 0.5 * (z + 1.0);
            let [low, high] = [0.0, 1.0].map(|own| shares(&even, 1e-6, (z, own)));
            let mut widths = Vec::new();
            for ((is_trigonometric, m, low), (.., high)) in low.iter().zip(&high) {
                let (low, high) = (low.expect("solvable"), high.expect("solvable"));
                // Trigonometric moments may place hair in the wrapping zone: then a part of it lies on the wrong side.
                let beyond = if *is_trigonometric { 0.03 } else { 1e-4 };
                let case = format!("{m}, {is_trigonometric}, at {z}: {low} to {high}, not {truth}");
                assert!(low <= truth + beyond && truth <= high + beyond && high - low < 0.6, "{case}");
                widths.push(high - low);
            }
            assert!(widths[2] < widths[0] && widths[5] < widths[3], "at {z}: {widths:?}");
        }
    }

    #[test]
    fn a_single_card_needs_the_bias_and_nan_has_no_distribution() {
        let card = [(0.5, 1.0)];
        assert!(shares(&card, 5e-5, (0.1, 0.25)).iter().all(|(.., share)| share.is_some()));
        assert!(shares(&card, 0.0, (0.1, 0.25)).iter().all(|(.., share)| share.is_none()), "control");
        assert!(shares(&[(f32::NAN, 1.0)], 5e-5, (0.1, 0.25)).iter().all(|(.., share)| share.is_none()));
    }
}
