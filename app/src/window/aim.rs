//! The direction of a hair tie as two angles: heading and rise.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::Vec3;
use lovelock_groom::HairTie;

/// The length of the horizontal part of a unit vector below which its heading is ignored.
const STEEP: f32 = 0.3;

/// A direction in head space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Aim {
    /// About the vertical, radians: 0 toward the back, where most ties are, a quarter turn toward the dancer's left, half a turn
    /// toward the front.
    pub(crate) heading: f32,
    /// Above the horizon, radians: a quarter turn is straight up.
    pub(crate) rise: f32,
}

impl Aim {
    /// Of a direction of any length; straight up and down head toward the back.
    pub(crate) fn of(axis: Vec3) -> Self {
        let axis = axis.normalize_or(Vec3::NEG_Z);
        let heading = if level(axis) < 1e-6 { 0.0 } else { axis.x.atan2(-axis.z) };
        // One direction must not be at both ends of the slider.
        let heading = if heading < 1e-6 - PI { PI } else { heading };
        Self { heading, rise: axis.y.clamp(-1.0, 1.0).asin() }
    }

    /// The unit vector. A straight vertical one keeps a small horizontal part, so that its heading is not lost.
    pub(crate) fn axis(self) -> Vec3 {
        let (x, z) = self.heading.sin_cos();
        Vec3::new(x, 0.0, -z) * self.rise.cos().max(1e-4) + Vec3::Y * self.rise.sin()
    }
}

/// The axis of a tie that is moved over the head, from a place with the normal `from` to one with the normal `to`. It keeps its
/// heading and rise relative to those of a new tie at the same place.
pub(crate) fn moved(axis: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let (plain, there) = (HairTie::axis_over(from), Aim::of(HairTie::axis_over(to)));
    let (now, usual) = (Aim::of(axis), Aim::of(plain));
    let is_steep = level(axis.normalize_or(Vec3::Y)).min(level(plain)) < STEEP;
    let aside = if is_steep { 0.0 } else { now.heading - usual.heading };
    let heading = (there.heading + aside + PI).rem_euclid(2.0 * PI) - PI;
    let rise = (there.rise + now.rise - usual.rise).clamp(-FRAC_PI_2, FRAC_PI_2);
    Aim { heading, rise }.axis()
}

/// Length of the horizontal part of a unit vector.
fn level(axis: Vec3) -> f32 {
    axis.x.hypot(axis.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_aim_comes_back() {
        for heading in [-3.0, -1.2, 0.0, 0.7, 2.9, PI] {
            for rise in [-1.5, -0.4, 0.0, 0.7, 1.5] {
                let back = Aim::of(3.0 * Aim { heading, rise }.axis());
                assert!((back.heading - heading).abs() < 1e-3 && (back.rise - rise).abs() < 1e-3, "{back:?}");
            }
        }
        let left = Aim { heading: FRAC_PI_2, rise: 0.0 }.axis();
        assert!(left.distance(Vec3::X) < 1e-6, "the dancer's left is +X: {left}");
        for back in [Vec3::Y, Vec3::NEG_Y, Vec3::new(-0.0, 0.3, -1.0)] {
            assert_eq!(Aim::of(back).heading, 0.0, "{back}");
        }
        for front in [Vec3::Z, Vec3::new(-0.0, 0.3, 1.0), Vec3::new(-1e-9, 0.0, 1.0)] {
            assert_eq!(Aim::of(front).heading, PI, "{front}");
        }
    }

    #[test]
    fn a_tie_that_is_moved_aims_off_the_head_as_it_did() {
        let usual = HairTie::axis_over;
        // A tie with the direction of a new one keeps it at every other place.
        for to in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::Z, Vec3::new(0.5, 0.5, -0.707)] {
            let moved = moved(usual(Vec3::NEG_Z), Vec3::NEG_Z, to);
            assert!(moved.distance(usual(to).normalize_or(Vec3::Y)) < 1e-3, "{moved} over {to}");
        }
        // What hangs down at the back hangs down at the side.
        let down = Vec3::new(0.0, -0.5, -1.0);
        let at_left = moved(down, Vec3::NEG_Z, Vec3::X);
        assert!((Aim::of(at_left).rise - Aim::of(down).rise).abs() < 1e-4 && at_left.x > 0.8, "{at_left}");
        // An angle to the side of the normal stays the same.
        let aside = Aim { heading: 0.5, rise: 0.2 }.axis();
        let at_left = Aim::of(moved(aside, Vec3::NEG_Z, Vec3::X));
        assert!((at_left.heading - (FRAC_PI_2 + 0.5)).abs() < 1e-3, "{at_left:?}");
        // From the crown, where there is no heading, it takes that of the new place.
        let from_crown = moved(Vec3::Y, Vec3::Y, Vec3::NEG_X);
        assert!(from_crown.x < -0.8 && from_crown.z.abs() < 1e-3, "{from_crown}");
    }
}
