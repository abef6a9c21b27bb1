//! The roots of polynomials all of whose roots are real. Twin of roots.wgsl.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]
// Indices as in the shader.
#![allow(clippy::needless_range_loop)]

/// The most steps toward each of the two outer roots. Near a root Laguerre's method triples the digits with every step; roots of very different
/// size take some steps to get there.
const STEPS: usize = 10;

/// A step of at most this share of the root is the last one: the next would change no digit.
const LEAST_CHANGE: f32 = 1e-3;

/// The roots of tᴹ + a₁ tᴹ⁻¹ + … for M from 2 to 4, with coefficients in `a` from a₁ on. If rounding has made two of them complex, both
/// are their real part.
#[inline(always)]
pub(super) fn real_roots<const M: usize>(a: &[f32; 5]) -> [f32; 4] {
    if M == 2 {
        let [one, other] = quadratic(a[1], a[2]);
        return [one, other, 0.0, 0.0];
    }
    let m = M as f32;
    // All roots lie this far from their mean (Laguerre, Samuelson).
    let mean = -a[1] / m;
    let spread = a[1] * a[1] - 2.0 * m / (m - 1.0) * a[2];
    let reach = (m - 1.0) / m * (if spread > 0.0 { spread } else { 0.0 }).sqrt();
    let low = outer_root::<M>(a, mean - reach);
    let high = outer_root::<M>(a, mean + reach);
    // The larger one is the largest of all.
    let (large, small) = if low.abs() > high.abs() { (low, high) } else { (high, low) };
    let mut rest = divided(a, M, large);
    if M == 4 {
        rest = divided(&rest, 3, small);
    }
    let [one, other] = quadratic(rest[1], rest[2]);
    if M == 3 { [large, one, other, 0.0] } else { [large, small, one, other] }
}

/// The quotient of a polynomial of degree `n` by t − `root`. It is divided from both ends, which meet at the largest term, so that roots
/// much smaller than others keep their digits (Peters, Wilkinson 1971).
#[inline(always)]
fn divided(a: &[f32; 5], n: usize, root: f32) -> [f32; 5] {
    let mut quotient = [1.0, 0.0, 0.0, 0.0, 0.0];
    for k in 1..n {
        quotient[k] = a[k] + quotient[k - 1] * root;
    }
    let (mut meet, mut largest, mut power) = (n, a[n].abs(), 1.0);
    for k in (0..n).rev() {
        power *= root.abs();
        let term = a[k].abs() * power;
        if term > largest {
            (meet, largest) = (k, term);
        }
    }
    if root != 0.0 {
        let mut entry = -a[n] / root;
        for k in (1..n).rev() {
            if k >= meet {
                quotient[k] = entry;
            }
            entry = (entry - a[k]) / root;
        }
    }
    quotient
}

/// The root next to `x`, which lies outside all of them: Laguerre's method, which passes none.
#[inline(always)]
fn outer_root<const M: usize>(a: &[f32; 5], mut x: f32) -> f32 {
    let m = M as f32;
    for _ in 0..STEPS {
        // The polynomial, its first derivative, and half of its second one.
        let (mut value, mut slope, mut bend) = (1.0, 0.0, 0.0);
        for k in 1..=M {
            bend = bend * x + slope;
            slope = slope * x + value;
            value = value * x + a[k];
        }
        let square = (m - 1.0) * ((m - 1.0) * slope * slope - 2.0 * m * value * bend);
        let root = (if square > 0.0 { square } else { 0.0 }).sqrt();
        let divisor = if slope < 0.0 { slope - root } else { slope + root };
        let change = if divisor == 0.0 { 0.0 } else { m * value / divisor };
        x -= change;
        if change.abs() <= LEAST_CHANGE * x.abs() {
            break;
        }
    }
    x
}

/// The roots of t² + `linear` t + `constant`, without the loss of digits of the usual formula.
#[inline(always)]
fn quadratic(linear: f32, constant: f32) -> [f32; 2] {
    let half = -0.5 * linear;
    let square = half * half - constant;
    let root = (if square > 0.0 { square } else { 0.0 }).sqrt();
    let outer = if half < 0.0 { half - root } else { half + root };
    [outer, if outer == 0.0 { 0.0 } else { constant / outer }]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coefficients(roots: &[f32]) -> [f32; 5] {
        let mut all = [1.0_f64, 0.0, 0.0, 0.0, 0.0];
        for (degree, root) in roots.iter().enumerate() {
            for k in (1..=degree + 1).rev() {
                all[k] -= all[k - 1] * f64::from(*root);
            }
        }
        all.map(|value| value as f32)
    }

    /// The largest error of a root, as a share of that root.
    fn worst<const M: usize>(sets: &[[f32; M]]) -> f32 {
        let mut worst = 0.0_f32;
        for set in sets {
            let mut found = real_roots::<M>(&coefficients(set))[..M].to_vec();
            let mut expected = set.to_vec();
            found.sort_by(f32::total_cmp);
            expected.sort_by(f32::total_cmp);
            let errors =
                found.iter().zip(&expected).map(|(found, root)| (found - root).abs() / root.abs().max(1e-3));
            worst = errors.fold(worst, f32::max);
        }
        worst
    }

    #[test]
    fn roots_are_found_also_where_one_is_at_0_or_far_away() {
        let two = worst(&[[1.0, -2.0], [0.0, 3.0], [1e-4, 50.0], [-7.0, -0.5]]);
        let three = worst(&[
            [1.0, -2.0, 0.5],
            [0.0, 0.3, 3.0],
            [-1.0, -1.5, 40.0],
            [-9.0, -0.1, -30.0],
            [1e4, 1.0, -1.0],
            [-1000.0, -0.4, 0.5],
        ]);
        let four = worst(&[
            [1.0, -2.0, 0.5, -0.7],
            [0.0, 0.4, -0.4, 3.0],
            [-1.0, -1.5, 2.0, 40.0],
            [1e4, 1.0, -1.0, 0.5],
            [-1000.0, -0.4, 0.5, 0.6],
            [1000.0, -900.0, 0.5, -0.4],
        ]);
        println!("{two:e}, {three:e}, {four:e} of a root");
        assert!(two < 1e-5 && three < 1e-5 && four < 1e-4, "{two:e}, {three:e}, {four:e}");
    }

    #[test]
    fn equal_roots_and_no_real_ones_give_numbers() {
        assert_eq!(real_roots::<4>(&[1.0, 0.0, 0.0, 0.0, 0.0]), [0.0; 4]);
        // (t² + 1)².
        assert!(real_roots::<4>(&[1.0, 0.0, 2.0, 0.0, 1.0]).iter().all(|root| root.is_finite()));
        assert_eq!(real_roots::<2>(&[1.0, 2.0, 2.0, 0.0, 0.0])[0], -1.0);
    }
}
