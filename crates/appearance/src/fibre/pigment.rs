//! Absorption of hair from its pigments or from a colour.

/// Absorption per radius of the fibre in red, green and blue for an amount of eumelanin (Chiang et al. 2016; pbrt).
pub const EUMELANIN: [f64; 3] = [0.419, 0.697, 1.37];
/// Absorption per radius of the fibre for an amount of pheomelanin.
pub const PHEOMELANIN: [f64; 3] = [0.187, 0.4, 1.05];

/// Absorption per radius of hair with two pigments. Black hair has about 8 of eumelanin, brown 1.3, blonde 0.3 and white 0; red
/// hair has about 0.8 of pheomelanin. Negative amounts and values that are not numbers count as zero.
pub fn absorption_of_melanin(eumelanin: f64, pheomelanin: f64) -> [f64; 3] {
    let (e, p) = (eumelanin.max(0.0), pheomelanin.max(0.0));
    [0, 1, 2].map(|c| e * EUMELANIN[c] + p * PHEOMELANIN[c])
}

/// Absorption per radius of dyed hair that has the linear colour `color` where much of it is lit from everywhere (Chiang et al.
/// 2016). It depends on the azimuthal roughness, because rough fibres make longer paths.
///
/// A channel is clamped to 0.001 to 1; a value that is not a number counts as black.
pub fn absorption_of_color(color: [f64; 3], roughness_around: f64) -> [f64; 3] {
    let default = super::Fibre::default();
    let b = super::Fibre { roughness_around, ..default }.clamped().roughness_around;
    let scale =
        5.969 - 0.215 * b + 2.532 * b.powi(2) - 10.73 * b.powi(3) + 5.574 * b.powi(4) + 0.245 * b.powi(5);
    // The maximum drops a value that is not a number.
    color.map(|c| (c.max(0.001).clamp(0.001, 1.0).ln() / scale).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pigments_and_colours_give_finite_absorption_that_falls_with_brightness() {
        assert_eq!(absorption_of_melanin(f64::NAN, -1.0), [0.0; 3]);
        let brown = absorption_of_melanin(1.3, 0.1);
        assert!((brown[0] - 0.5634).abs() < 1e-9 && (brown[2] - 1.886).abs() < 1e-9);
        for b in [0.0, 0.05, 0.3, 0.99, 1.0, f64::NAN] {
            let mut last = f64::INFINITY;
            for c in [f64::NAN, 0.0, 0.01, 0.3, 0.9, 1.0, 7.0] {
                let sigma = absorption_of_color([c; 3], b)[1];
                assert!(sigma.is_finite() && sigma >= 0.0 && sigma <= last, "{c} {b}");
                last = sigma;
            }
            assert_eq!(last, 0.0);
        }
        // By hand: ln(0.5) / (5.969 - 0.0645 + 0.22788 - 0.28971 + 0.04515 + 0.0006) = -0.11770.
        assert!((absorption_of_color([0.5; 3], 0.3)[0] - 0.013_853).abs() < 1e-5);
    }
}
