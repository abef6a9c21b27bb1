//! A body at one instant.

use glam::Affine3A;

/// Where every joint is at one instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// When, on the clip's clock, seconds.
    pub time_secs: f64,
    /// Transform of each joint to the world.
    pub world_from_joint: Vec<Affine3A>,
    /// Carries head space (see `lovelock_groom`) to the world: rigid, no scale.
    pub world_from_head: Affine3A,
    /// Weights of the morph targets; empty where the body has none.
    pub morph_weights: Vec<f32>,
}
