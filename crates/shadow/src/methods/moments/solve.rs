//! From four power moments to the share of hair before a depth. Twin of solve.wgsl.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

/// The even distribution that is mixed in: its moments, which are far from the border of what moments can be.
const EVEN: [f32; 4] = [0.0, 0.375, 0.0, 0.375];

/// The least variance and pivot with which the system counts as solvable.
const LEAST_PIVOT: f32 = 1e-12;

/// Biased moments and the Cholesky factors of their Hankel matrix, B = L D Lᵀ.
#[derive(Clone, Copy, Debug)]
pub(super) struct System {
    moments: [f32; 4],
    /// The entries of L below its diagonal that are not moments.
    l21: f32,
    /// The second and third entry of D.
    d: [f32; 2],
}

impl System {
    /// The system of the means of z, z², z³ and z⁴.
    #[inline(always)]
    pub(super) fn new(moments: [f32; 4], bias: f32) -> Self {
        let mixed = |k: usize| moments[k] + (EVEN[k] - moments[k]) * bias;
        let b = [mixed(0), mixed(1), mixed(2), mixed(3)];
        let variance = b[1] - b[0] * b[0];
        let covariance = b[2] - b[0] * b[1];
        let l21 = covariance / variance;
        let last = (b[3] - b[1] * b[1]) - covariance * l21;
        Self { moments: b, l21, d: [variance, last] }
    }

    /// Whether the matrix is positive definite. Rounding to 16 bits and a small bias may make it indefinite: then no distribution has
    /// these moments. False for NaN.
    #[inline(always)]
    pub(super) fn is_solvable(&self) -> bool {
        self.d[0] > LEAST_PIVOT && self.d[1] > LEAST_PIVOT
    }

    /// The share of hair before `z`, of which a point's own depth counts by `overestimation`. Only of a solvable system.
    ///
    /// The distribution with the given moments that has hair at `z` has it at two more depths, the roots of a polynomial; the
    /// polynomial of degree 2 through the wanted values at the three depths, applied to the moments, is the share.
    #[inline(always)]
    pub(super) fn share_before(&self, z: f32, overestimation: f32) -> f32 {
        let b = self.moments;
        // B c = (1, z, z²).
        let mut c = [1.0, z - b[0], 0.0];
        c[2] = z * z - b[1] - self.l21 * c[1];
        c[1] /= self.d[0];
        c[2] /= self.d[1];
        c[1] -= self.l21 * c[2];
        c[0] -= c[1] * b[0] + c[2] * b[1];
        let (linear, constant) = (c[1] / c[2], c[0] / c[2]);
        let square = linear * linear * 0.25 - constant;
        let root = (if square > 0.0 { square } else { 0.0 }).sqrt();
        let (near, far) = (-0.5 * linear - root, -0.5 * linear + root);
        let value = |at: f32| if at < z { 1.0 } else { 0.0 };
        let (f0, f1, f2) = (overestimation, value(near), value(far));
        let f01 = (f1 - f0) / (near - z);
        let f12 = (f2 - f1) / (far - near);
        let f012 = (f12 - f01) / (far - z);
        // The Newton form at z, near and far.
        let linear = f01 - f012 * near;
        let constant = f0 - linear * z;
        let share = constant + (linear - f012 * z) * b[0] + f012 * b[1];
        // NaN, where roots coincide, becomes 0.
        let share = if share > 0.0 { share } else { 0.0 };
        if share < 1.0 { share } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The moments of hair at depths with weights that add up to 1.
    fn moments(of: &[(f32, f32)]) -> [f32; 4] {
        [1, 2, 3, 4].map(|k| {
            of.iter().map(|(z, weight)| f64::from(*weight) * f64::from(*z).powi(k)).sum::<f64>() as f32
        })
    }

    #[test]
    fn three_cards_are_told_apart_but_for_the_bias() {
        let cards = [(-0.7, 0.25), (0.1, 0.5), (0.8, 0.25)];
        let system = System::new(moments(&cards), 5e-7);
        assert!(system.is_solvable());
        for (z, share) in [(-0.7, 0.25 * 0.25), (0.1, 0.25 + 0.25 * 0.5), (0.8, 0.75 + 0.25 * 0.25)] {
            let found = system.share_before(z, 0.25);
            assert!((found - share).abs() < 2e-3, "at {z}: {found}, not {share}");
        }
    }

    #[test]
    fn bounds_hold_the_truth_between_them() {
        // Even hair between −1 and 1: the moments are 0, 1/3, 0, 1/5.
        let system = System::new([0.0, 1.0 / 3.0, 0.0, 0.2], 5e-7);
        for i in -9_i16..=9 {
            let z = f32::from(i) * 0.1;
            let share = 0.5 * (z + 1.0);
            let [low, high] = [0.0, 1.0].map(|own| system.share_before(z, own));
            assert!(low <= share && share <= high && high - low < 0.6, "at {z}: {low} to {high}");
        }
    }

    #[test]
    fn a_single_card_needs_the_bias() {
        let card = moments(&[(0.5, 1.0)]);
        assert!(System::new(card, 5e-7).is_solvable());
        assert!(!System::new(card, 0.0).is_solvable(), "control");
        assert!(!System::new([f32::NAN; 4], 5e-7).is_solvable());
    }
}
