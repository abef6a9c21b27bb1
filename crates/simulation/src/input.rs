//! The state of the body that a simulation step takes as input.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_motion::{BodyField, FieldPose, PlacedCollider};

/// The body at the end of a step. The simulator remembers the previous one and interpolates between them over
/// the substeps.
#[derive(Clone, Copy, Debug)]
pub struct StepInput<'a> {
    /// Time on the clip's clock, seconds. Going back, or advancing by more than half a second, counts as a
    /// jump if the head has moved as well.
    pub time_secs: f64,
    /// Carries head space to world space: rigid, no scale. More than 0.5 m or a radian in one step is always
    /// a jump.
    pub world_from_head: Affine3A,
    /// What hair collides with, in world space: the same list in the same order in every step.
    pub colliders: &'a [PlacedCollider],
    /// Further shapes that shelter hair from the wind, in world space: those that the field replaces. If
    /// there is a field and this list is empty, the head shelters.
    pub sheltering: &'a [PlacedCollider],
    /// The field of head and shoulders, which replaces some of the colliders.
    pub field: Option<PlacedField<'a>>,
}

/// A field and its pose.
#[derive(Clone, Copy, Debug)]
pub struct PlacedField<'a> {
    /// The field at rest: the same one in every step.
    pub field: &'a Arc<BodyField>,
    /// Where its joints are now.
    pub pose: &'a FieldPose,
}

impl<'a> StepInput<'a> {
    /// A head and colliders, without a field.
    pub fn new(time_secs: f64, world_from_head: Affine3A, colliders: &'a [PlacedCollider]) -> Self {
        Self { time_secs, world_from_head, colliders, sheltering: &[], field: None }
    }
}
