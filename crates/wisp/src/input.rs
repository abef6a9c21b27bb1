//! What the body does to the hair in one step.

use glam::Affine3A;
use lovelock_motion::PlacedCollider;

/// The body at the end of a step. The simulator keeps the one before and moves between them in substeps.
#[derive(Clone, Copy, Debug)]
pub struct StepInput<'a> {
    /// When, on the clip's clock, seconds. Going back, or further on than half a second, is a jump.
    pub time_secs: f64,
    /// Carries head space to world space: rigid, no scale.
    pub world_from_head: Affine3A,
    /// What hair collides with, in world space: the same list in the same order from step to step.
    pub colliders: &'a [PlacedCollider],
}
