//! The solid that hair must stay outside of.

use glam::Vec3;

use lovelock_base::numbers::within;

/// A solid that hair is combed around: the body without its hair, in head space.
pub trait Obstacle: Sync {
    /// Signed distance in metres from `p` to the surface (negative inside), and the outward unit normal of the
    /// surface nearest to `p`. Both are finite for a finite `p`; the distance may be approximate away from the
    /// surface, but its sign is right.
    fn distance(&self, p: Vec3) -> (f32, Vec3);
}

/// An obstacle without a surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoObstacle;

impl Obstacle for NoObstacle {
    fn distance(&self, _: Vec3) -> (f32, Vec3) {
        (1.0, Vec3::Y)
    }
}

/// The largest depth inside a body that is taken for real, metres.
const DEEPEST: f32 = 0.02;

/// An obstacle whose results are finite and never move hair far, whatever the wrapped obstacle returns.
///
/// Near the open edges of clothes, the distance of a mesh may have the wrong sign. A point that seems to be deep inside is
/// therefore moved only in small steps, and returns to its path beyond such a place.
pub struct Bounded<'a>(pub &'a dyn Obstacle);

impl Obstacle for Bounded<'_> {
    fn distance(&self, p: Vec3) -> (f32, Vec3) {
        let (distance, normal) = self.0.distance(p);
        (within(distance, -DEEPEST, 1.0, 1.0), if normal.is_finite() { normal } else { Vec3::Y })
    }
}
