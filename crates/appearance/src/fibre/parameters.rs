//! Shape of a fibre.

/// Smallest roughness of the definition, in both directions.
const SMOOTHEST: f64 = 0.05;

/// Shape of a fibre: everything about its scattering except its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fibre {
    /// Longitudinal roughness, 0.05 to 1. Symbol: `beta_m`.
    pub roughness_along: f64,
    /// Azimuthal roughness, 0.05 to 1. Symbol: `beta_n`.
    pub roughness_around: f64,
    /// Tilt of the cuticle scales, in radians. Scales that open toward the tip have a negative tilt, because the tangent points
    /// from root to tip. Symbol: alpha.
    pub tilt: f64,
    /// Index of refraction, 1.01 to 3. Symbol: eta.
    pub index: f64,
}

impl Default for Fibre {
    fn default() -> Self {
        Self { roughness_along: 0.3, roughness_around: 0.3, tilt: (-2.0_f64).to_radians(), index: 1.55 }
    }
}

impl Fibre {
    /// The fibre with every value in its range. A value that is not a number becomes the default; the tilt stays within 30
    /// degrees.
    pub fn clamped(self) -> Self {
        let default = Self::default();
        let clamp = |value: f64, default: f64, low: f64, high: f64| {
            if value.is_nan() { default } else { value.clamp(low, high) }
        };
        let steepest = 30.0_f64.to_radians();
        Self {
            roughness_along: clamp(self.roughness_along, default.roughness_along, SMOOTHEST, 1.0),
            roughness_around: clamp(self.roughness_around, default.roughness_around, SMOOTHEST, 1.0),
            tilt: clamp(self.tilt, default.tilt, -steepest, steepest),
            index: clamp(self.index, default.index, 1.01, 3.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Fibre;

    #[test]
    fn values_out_of_range_are_clamped_and_nan_becomes_the_default() {
        let nan =
            Fibre { roughness_along: f64::NAN, roughness_around: f64::NAN, tilt: f64::NAN, index: f64::NAN };
        assert_eq!(nan.clamped(), Fibre::default());
        let huge =
            Fibre { roughness_along: 9.0, roughness_around: f64::INFINITY, tilt: 9.0, index: 9.0 }.clamped();
        assert_eq!((huge.roughness_along, huge.roughness_around, huge.index), (1.0, 1.0, 3.0));
        assert!(huge.tilt < 0.53);
        let tiny = Fibre { roughness_along: -1.0, roughness_around: 0.0, tilt: 0.0, index: -1.0 }.clamped();
        assert_eq!((tiny.roughness_along, tiny.roughness_around, tiny.index), (0.05, 0.05, 1.01));
    }
}
