//! The data that all blocks share in one step.

use glam::Vec3;

use crate::SimulationSettings;
use crate::block::BendingKey;
use crate::colliders::MovingShape;
use crate::colliders::contact::ContactRules;
use crate::colliders::field::MovingField;
use crate::grid::DensityGrid;
use crate::lanes::Map;
use crate::motion::Substep;
use crate::rates::RowRates;
use crate::rope::MiddleLine;
use crate::wake::Wakes;
use crate::wind::WindField;

/// One step, prepared once and read by every block.
#[derive(Clone, Copy)]
pub(crate) struct Plan<'a> {
    /// Whether to use the vector instructions of this CPU.
    pub(crate) wide: bool,
    pub(crate) settings: SimulationSettings,
    pub(crate) h: f32,
    /// What changes along a guide, for each of its points.
    pub(crate) rows: &'a [RowRates],
    /// The middle lines of gathered hair at the start of the step, in this step's working space.
    pub(crate) ropes: &'a [MiddleLine],
    /// The first point that the scalp does not carry.
    pub(crate) first_free: usize,
    /// Translation from the last step's working space to this one's.
    pub(crate) rebase: Vec3,
    /// From the head at the start of the step to the head at its end, both in this step's working space.
    pub(crate) carry_all: Map,
    /// From the last step's working space to head space at the start of the step.
    pub(crate) head_from_last: Map,
    /// From head space to the last step's working space, at the start of the step.
    pub(crate) last_head: Map,
    pub(crate) substeps: &'a [Substep],
    /// The colliders of every substep, one substep after the other.
    pub(crate) shapes: &'a [MovingShape],
    pub(crate) shapes_per_substep: usize,
    pub(crate) field: Option<&'a MovingField>,
    pub(crate) rules: ContactRules,
    pub(crate) bending: BendingKey,
    /// The grid with the hair of the start of the step; `None` where another device deposits the hair.
    pub(crate) grid: Option<&'a DensityGrid>,
    pub(crate) wind: &'a WindField,
    pub(crate) wakes: &'a Wakes,
}

impl Plan<'_> {
    /// What the end of the step needs of it.
    pub(crate) fn ending(&self) -> Ending {
        let Plan { first_free, rebase, carry_all, .. } = *self;
        Ending { first_free, rebase, carry_all, last: self.substeps.last().copied() }
    }
}

/// The part of a [`Plan`] with which the state after a step is measured, and guides that are not finite are reset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ending {
    pub(crate) first_free: usize,
    pub(crate) rebase: Vec3,
    pub(crate) carry_all: Map,
    /// The head at the end of the step.
    pub(crate) last: Option<Substep>,
}
