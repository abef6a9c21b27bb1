//! What all blocks share in one step.

use glam::Vec3;

use super::BendingKey;
use crate::SimulationSettings;
use crate::colliders::MovingShape;
use crate::colliders::contact::ContactRules;
use crate::colliders::field::MovingField;
use crate::grid::DensityGrid;
use crate::lanes::{Map, Turn};
use crate::wake::Wakes;
use crate::wind::WindField;

/// The head at one substep, in working space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Substep {
    /// Carries head space to working space.
    pub(crate) head: Map,
    pub(crate) head_turn: Turn,
    /// Velocity of a point that moves rigidly with the head.
    pub(crate) rigid: Map,
}

impl Substep {
    #[inline(always)]
    pub(crate) fn rigid_velocity(&self, p: Vec3) -> Vec3 {
        self.rigid.apply(p)
    }
}

/// One step, worked out once and read by every block.
pub(crate) struct Plan<'a> {
    /// Whether to use the instructions of this processor.
    pub(crate) wide: bool,
    pub(crate) settings: SimulationSettings,
    pub(crate) h: f32,
    /// The first point that the scalp does not carry.
    pub(crate) first_free: usize,
    /// From the last step's working space to this one's.
    pub(crate) rebase: Vec3,
    /// From the head at the start of the step to the head at its end, both in this step's working space.
    pub(crate) carry_all: Map,
    /// From the last step's working space to head space at the start of the step.
    pub(crate) head_from_last: Map,
    /// The turn of the head at the start of the step.
    pub(crate) last_head: Map,
    pub(crate) substeps: &'a [Substep],
    /// The colliders of every substep, one substep after the other.
    pub(crate) shapes: &'a [MovingShape],
    pub(crate) shapes_per_substep: usize,
    pub(crate) field: Option<&'a MovingField>,
    pub(crate) rules: ContactRules,
    pub(crate) bending: BendingKey,
    pub(crate) grid: &'a DensityGrid,
    pub(crate) wind: &'a WindField,
    pub(crate) wakes: &'a Wakes,
}
