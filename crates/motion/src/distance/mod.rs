//! Signed distance of the resting body.

use glam::Vec3;

use crate::Body;

/// Signed distance and outward normal of the resting body, in head space.
#[derive(Clone, Debug, Default)]
pub struct RestDistance {}

impl RestDistance {
    /// Builds it.
    pub fn new(_body: &Body) -> Self {
        Self {}
    }

    /// Distance in metres, negative inside, and outward unit normal at a point of head space.
    pub fn distance(&self, _p: Vec3) -> (f32, Vec3) {
        (1.0, Vec3::Y)
    }
}
