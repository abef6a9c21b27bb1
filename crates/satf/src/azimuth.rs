//! Directions in space as azimuths in the plane of a sector.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;

/// Within this angle of the strands a direction has no azimuth, radians: 5°.
const LEAST_ANGLE: f32 = 0.087_266_46;

/// A direction seen within the plane of a sector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Azimuth {
    /// Radians from the outward normal, positive toward rising u. 0 where it is undefined.
    pub theta: f32,
    /// 1 where the azimuth is certain, falling to 0 within 5° of the strands: the weight of a record against the mean over
    /// all azimuths ([`crate::Database::sample_any_view`]).
    pub certainty: f32,
}

impl Azimuth {
    /// The azimuth of the unit vector `toward`, away from the sector, whose plane has the axes `outward` and `along` (toward
    /// rising u), unit vectors square to each other.
    pub fn of(toward: Vec3, outward: Vec3, along: Vec3) -> Self {
        let (s, t) = (toward.dot(along), toward.dot(outward));
        let across = s.hypot(t);
        if across > 1e-6 {
            Self { theta: s.atan2(t), certainty: smoothstep(0.5 * LEAST_ANGLE, LEAST_ANGLE, across) }
        } else {
            // Also for NaN.
            Self { theta: 0.0, certainty: 0.0 }
        }
    }
}
