//! What the body does to the hair in one step.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_motion::{BodyField, FieldPose, PlacedCollider};

/// The body at the end of a step. The simulator keeps the one before and moves between them in substeps.
#[derive(Clone, Copy, Debug)]
pub struct StepInput<'a> {
    /// When, on the clip's clock, seconds. Going back, or further on than half a second, is a jump where the head is
    /// elsewhere then.
    pub time_secs: f64,
    /// Carries head space to world space: rigid, no scale. Further than 0.5 m or a radian in one step is a jump at any time.
    pub world_from_head: Affine3A,
    /// What hair collides with, in world space: the same list in the same order from step to step.
    pub colliders: &'a [PlacedCollider],
    /// What keeps the wind off besides, in world space: the shapes that the field stands for. Where there is a field and
    /// none of these, the head does.
    pub sheltering: &'a [PlacedCollider],
    /// The field of head and shoulders, for what the colliders leave out.
    pub field: Option<PlacedField<'a>>,
}

/// A field and where it is.
#[derive(Clone, Copy, Debug)]
pub struct PlacedField<'a> {
    /// The field at rest: the same one from step to step.
    pub field: &'a Arc<BodyField>,
    /// Where its joints are now.
    pub pose: &'a FieldPose,
}

impl<'a> StepInput<'a> {
    /// A head and what hair collides with, without a field.
    pub fn new(time_secs: f64, world_from_head: Affine3A, colliders: &'a [PlacedCollider]) -> Self {
        Self { time_secs, world_from_head, colliders, sheltering: &[], field: None }
    }
}
