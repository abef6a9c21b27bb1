//! Rates that change along a guide.

use glam::Vec3;

use crate::SimulationSettings;
use crate::lanes::lesser;

/// What changes along a guide: fractions of a difference that vanish in a substep, at one row of points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RowRates {
    /// Of the distance beyond the bound of a lock.
    pub(crate) cohesion: f32,
    /// Of the velocity relative to the lock.
    pub(crate) lock_friction: f32,
    /// The drag of slow air times the substep.
    pub(crate) drag: f32,
    /// The largest change of velocity by friction on other hair, which presses on a point with its weight, metres per second.
    pub(crate) hair_friction: f32,
}

impl RowRates {
    /// The rates at the fraction `along` of a guide, 0 at the root and 1 at the tip, in a substep of `h` seconds.
    pub(crate) fn at(along: f32, settings: &SimulationSettings, h: f32) -> Self {
        let taken = |rate: f32| 1.0 - (-rate * h).exp();
        let toward = |tip: f32| 1.0 + (tip - 1.0) * along;
        let locks = &settings.locks;
        Self {
            cohesion: taken(locks.cohesion * toward(locks.cohesion_tip)),
            lock_friction: taken(locks.friction),
            drag: settings.drag * toward(settings.drag_tip) / settings.weight_at(along) * h,
            hair_friction: settings.hair_friction * toward(settings.hair_friction_tip) * settings.gravity * h,
        }
    }
}

/// Below this speed friction is viscous, so that hair at rest yields to a small force and returns to its style, metres per
/// second.
const CREEP: f32 = 0.03;

/// The constants of friction by name, for other devices.
pub(crate) const CONSTANTS: [(&str, f64); 1] = [("CREEP", CREEP as f64)];

/// The fraction of a `relative` velocity that friction removes which can change it by `most`, metres per second
/// (Coulomb's law): `most` of a fast one, and in proportion to it of a slow one.
#[inline(always)]
pub(crate) fn rubbed(most: f32, relative: Vec3) -> f32 {
    lesser(most / (relative.length_squared() + CREEP * CREEP).sqrt(), 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_stops_hair_at_a_constant_rate_and_never_turns_it_round() {
        let (h, friction) = (1.0 / 240.0_f32, 0.1);
        let settings = SimulationSettings { hair_friction: friction, ..SimulationSettings::default() };
        let most = RowRates::at(0.0, &settings, h).hair_friction;
        let mut v = Vec3::new(1.0, 0.0, 0.0);
        let mut last = v.x;
        for n in 1..480 {
            v -= v * rubbed(most, v);
            assert!(v.x >= 0.0 && v.x <= last, "substep {n}: {}", v.x);
            if v.x > 0.2 {
                // Less than 5 % of the speed is creep there.
                let lost = friction * 9.81 * h;
                assert!((last - v.x - lost).abs() < 0.05 * lost, "substep {n}: {} of {lost}", last - v.x);
            }
            last = v.x;
        }
        // 1 m/s at 0.98 m/s^2: at rest within 1.1 s.
        assert!(v.x < 1e-3, "{}", v.x);
        assert_eq!(rubbed(0.0, Vec3::X), 0.0, "control: nothing rubs without friction");
        assert!(rubbed(1e9, Vec3::X) <= 1.0);
    }

    #[test]
    fn rates_follow_their_ramps() {
        let mut settings = SimulationSettings {
            weight: 2.0,
            weight_tip: 0.5,
            drag_tip: 3.0,
            ..SimulationSettings::default()
        };
        settings.locks.cohesion_tip = 0.0;
        let [root, tip] = [0.0, 1.0].map(|along| RowRates::at(along, &settings, 1e-3));
        // Three times the air on half of the weight.
        assert!((tip.drag / root.drag - 6.0).abs() < 1e-5);
        assert!(root.cohesion > 0.05 && tip.cohesion == 0.0);
    }
}
