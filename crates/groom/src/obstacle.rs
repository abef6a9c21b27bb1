//! What hair must stay outside of.

use glam::Vec3;

/// A solid that hair is combed around: the body without its hair, in head space.
pub trait Obstacle: Sync {
    /// Signed distance in metres from `p` to the surface (negative inside), and the outward unit normal of the
    /// surface nearest to `p`. Both are finite for a finite `p`; the distance may be approximate away from the
    /// surface, but its sign is right.
    fn distance(&self, p: Vec3) -> (f32, Vec3);
}

/// Nothing to collide with.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoObstacle;

impl Obstacle for NoObstacle {
    fn distance(&self, _: Vec3) -> (f32, Vec3) {
        (1.0, Vec3::Y)
    }
}
