//! Integrals by the rule of Gauss and Legendre.

use std::f64::consts::PI;

/// Nodes in -1..1 and weights of the Gauss-Legendre rule. The weights sum to 2.
#[derive(Clone, Debug)]
pub struct Quadrature {
    /// Node and weight of every point.
    pub points: Vec<(f64, f64)>,
}

impl Quadrature {
    /// The rule with `count` points (at least one), exact for polynomials up to degree `2 * count - 1`.
    pub fn new(count: usize) -> Self {
        let n = count.max(1);
        let points = (0..n)
            .map(|i| {
                let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
                let mut slope = 1.0;
                // Newton's method from this start doubles the correct digits at every step.
                for _ in 0..8 {
                    let (mut p, mut before) = (x, 1.0);
                    for k in 2..=n {
                        let k = k as f64;
                        (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
                    }
                    slope = n as f64 * (x * p - before) / (x * x - 1.0);
                    x -= p / slope;
                }
                (x, 2.0 / ((1.0 - x * x) * slope * slope))
            })
            .collect();
        Self { points }
    }

    /// Integral of `f` from `low` to `high`.
    pub fn integrate(&self, low: f64, high: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        half * self.points.iter().map(|&(x, weight)| weight * f(middle + half * x)).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::Quadrature;

    #[test]
    fn exact_for_polynomials_of_its_degree_and_no_higher() {
        let rule = Quadrature::new(4);
        let power = |degree: i32| rule.integrate(0.0, 1.0, |x| x.powi(degree)) - 1.0 / f64::from(degree + 1);
        assert!((0..=7).all(|degree| power(degree).abs() < 1e-14));
        assert!(power(8).abs() > 1e-6);
        let many = Quadrature::new(96);
        assert!((many.integrate(0.0, 2.0, f64::exp) - (2.0_f64.exp() - 1.0)).abs() < 1e-12);
        assert_eq!(Quadrature::new(0).points.len(), 1);
    }
}
