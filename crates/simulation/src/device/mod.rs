//! A step on another device than the CPU: what the step needs as plain numbers, and what the device returns.
//!
//! Only the guides are advanced elsewhere. The head, the colliders, the maps of the field, the wind and the ropes of
//! a step are prepared here in either case, and after the step the state of the guides is in the
//! [`Simulation`](crate::Simulation) again, or at least what moves: see [`Reads`]. A device that refuses a step changes nothing,
//! and the CPU then does the whole step.
//!
//! Lists of rows hold one number per *slot*. A block has [`SLOTS`] slots, one per lane, and the number of point `i` of
//! block `b` in slot `k` is at `(b * points + i) * SLOTS + k`. Vectors have three such numbers, axis by axis: that of
//! an axis is at `((b * points + i) * 3 + axis) * SLOTS + k`.

mod constants;
mod frame;
mod rows;

pub use constants::{constants, grid_size};
pub use frame::{FRAME_WAVES, FrameOffsets};
pub(crate) use rows::read_rest;
pub use rows::{MOTION_ROWS, STATE_ROWS};

pub use crate::contents::Stamp;
pub(crate) use crate::contents::Stamps;

pub use crate::block::BendingKey;
use crate::block::{Block, Depth, Outcome};
pub use crate::colliders::field::{FieldLattices, MovingField};
use crate::dispatch::accept_block;
use crate::grid::DensityGrid;
use crate::lanes::LANES;
use crate::solver::{Ending, FACTOR_CHECK_INTERVAL, Plan};
use crate::{Integrator, RepulsionMode, SimulationSettings};
use glam::Vec3;
use rayon::prelude::*;

/// Slots per block.
pub const SLOTS: usize = LANES;

/// Advances guides by a step.
///
/// The errors say in a sentence why the device cannot do what is asked.
pub trait StepDevice: Send {
    /// Begins `step`, and copying what `reads` says to memory.
    ///
    /// # Errors
    /// The device does not take the step, and nothing has begun.
    fn begin(&mut self, step: &DeviceStep, reads: Reads) -> Result<(), String>;

    /// Waits for the step that was begun last.
    ///
    /// # Errors
    /// The step is not done.
    fn finish(&mut self) -> Result<&DeviceOutcome, String>;

    /// Whether the device holds the state with this stamp.
    fn holds(&self, state: Stamp) -> bool;

    /// Reads the rows of [`DeviceStep::write_state`] at the end of the last step.
    ///
    /// # Errors
    /// There is no such state, or it cannot be read.
    fn read_state(&mut self) -> Result<&[f32], String>;
}

/// What is read back of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reads {
    /// All [`STATE_ROWS`] of the state.
    State,
    /// Positions and velocities, the first [`MOTION_ROWS`]. The rest stays on the device, and is read when something else than this
    /// device goes on with it.
    Motion,
}

impl Reads {
    /// Numbers per point and slot that are read.
    pub fn rows(self) -> usize {
        match self {
            Self::State => STATE_ROWS,
            Self::Motion => MOTION_ROWS,
        }
    }
}

/// What a device returns about a step.
#[derive(Clone, Debug, Default)]
pub struct DeviceOutcome {
    /// The rows of [`DeviceStep::write_state`] at the end of the step: the first ones, as many as [`Reads::rows`].
    pub state: Vec<f32>,
    /// The contacts of each slot.
    pub contacts: Vec<SlotContact>,
    /// Cells of the density grid above their threshold.
    pub over_dense_cells: u32,
    /// Sum of the masses of the cells, each at most that of a full cell, in units of the grid.
    pub fullness: u32,
}

/// The penetration of a guide into the body at the end of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct SlotContact {
    /// The deepest penetration, metres.
    pub depth_m: f32,
    /// The point with that penetration.
    pub point: u32,
    /// Index of the collider with that penetration; [`u32::MAX`] for the field.
    pub collider: u32,
    /// Number of points near skin whose position is only a guess.
    pub unsure: u32,
    /// The first of those.
    pub first_unsure: u32,
}

/// One step for a device.
pub struct DeviceStep<'a> {
    pub(crate) plan: &'a Plan<'a>,
    pub(crate) blocks: &'a [Block],
    pub(crate) grid: &'a DensityGrid,
    pub(crate) stamps: Stamps,
    pub(crate) after: Stamp,
    pub(crate) place: Vec3,
}

impl DeviceStep<'_> {
    /// The number of blocks; at least 1.
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// Points per guide; at least 2.
    pub fn points(&self) -> usize {
        self.blocks.first().map_or(0, Block::points)
    }

    /// Numbers in a list with one number per point and slot.
    pub fn numbers(&self) -> usize {
        self.blocks() * self.points() * SLOTS
    }

    /// The settings of the step.
    pub fn settings(&self) -> &SimulationSettings {
        &self.plan.settings
    }

    /// The method that keeps the lengths of links.
    pub fn integrator(&self) -> Integrator {
        self.plan.settings.integrator
    }

    /// Whether lengths are factorised again in substep `s` where links have turned.
    pub fn checks_factor(&self, s: usize) -> bool {
        s.is_multiple_of(FACTOR_CHECK_INTERVAL)
    }

    /// Length of a substep, seconds.
    pub fn substep_secs(&self) -> f32 {
        self.plan.h
    }

    /// Number of substeps.
    pub fn substeps(&self) -> usize {
        self.plan.substeps.len()
    }

    /// The first point that the scalp does not carry.
    pub fn first_free(&self) -> usize {
        self.plan.first_free
    }

    /// Number of colliders.
    pub fn colliders(&self) -> usize {
        self.plan.shapes_per_substep
    }

    /// Translation of positions from the last step to this one, metres.
    pub fn rebase(&self) -> Vec3 {
        self.plan.rebase
    }

    /// The place of the head at the end of the step, metres: positions in world space are those of the state and this.
    pub fn place(&self) -> Vec3 {
        self.place
    }

    /// Writes the number of the guide in each slot, [`u32::MAX`] in those of none.
    pub fn write_guide_numbers(&self, out: &mut Vec<u32>) {
        out.clear();
        for block in self.blocks {
            out.extend((0..SLOTS).map(|k| if k < block.used { block.guides[k] } else { u32::MAX }));
        }
    }

    /// Fraction of the velocity relative to the surrounding hair that vanishes in a step.
    pub fn cohesion(&self) -> f32 {
        let (rate, secs) = (self.plan.settings.repulsion.cohesion, self.plan.h * self.substeps() as f32);
        1.0 - (-rate * secs).exp()
    }

    /// Fraction of the velocity relative to the head that vanishes in a substep.
    pub fn settle(&self) -> f32 {
        1.0 - (-self.plan.settings.settle * self.plan.h).exp()
    }

    /// The distance that any point may keep from a surface, metres.
    pub fn reach(&self) -> f32 {
        self.plan.rules.reach()
    }

    /// What the matrices of bends are computed from, besides the guides.
    pub fn bends(&self) -> BendingKey {
        self.plan.bending
    }

    /// Ratio of the damping of bends to their stiffness in a substep.
    pub fn bend_gamma(&self) -> f32 {
        self.plan.bending.gamma()
    }

    /// The lowest corner of the density grid in head space, its cell size, the spacing of deposited points along a
    /// guide, and the fixed-point units per metre of a guide.
    pub fn lattice(&self) -> (Vec3, f32, usize, f32) {
        self.grid.lattice_numbers()
    }

    /// The mass of a full cell of the density grid, in its units.
    pub fn full_mass(&self) -> f32 {
        self.grid.full_by(self.plan.settings.repulsion.mode)
    }

    /// Whether hair is counted in the cell that contains it instead of in the eight around it.
    pub fn counts_nearest(&self) -> bool {
        self.plan.settings.repulsion.mode == RepulsionMode::Centre
    }

    /// The inverse rest density of each cell by the current way of counting.
    pub fn write_rest_density(&self, out: &mut Vec<f32>) {
        self.grid.write_rest_density(self.plan.settings.repulsion.mode, out);
    }

    /// The field of head and shoulders, if there is one.
    pub fn field(&self) -> Option<&MovingField> {
        self.plan.field
    }

    /// The content of [`DeviceStep::write_guides`].
    pub fn guides_stamp(&self) -> Stamp {
        self.stamps.guides
    }

    /// The content of [`DeviceStep::write_distances`].
    pub fn distances_stamp(&self) -> Stamp {
        self.stamps.distances
    }

    /// The content of [`DeviceStep::write_state`].
    pub fn state_stamp(&self) -> Stamp {
        self.stamps.state
    }

    /// The state after the step, if the device does it.
    pub fn state_after(&self) -> Stamp {
        self.after
    }
}

impl std::fmt::Debug for DeviceStep<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("DeviceStep").field("blocks", &self.blocks.len()).finish_non_exhaustive()
    }
}

/// Writes the rows of `outcome`, as many as `reads` says, and the contacts that a device returned into `blocks`, resets guides that are not
/// finite, and measures all. Returns whether the state is that of the device.
///
/// # Errors
/// The outcome has another size than the guides.
pub(crate) fn accept(
    blocks: &mut [Block],
    ending: &Ending,
    outcome: &DeviceOutcome,
    reads: Reads,
) -> Result<bool, String> {
    let points = blocks.first().map_or(0, Block::points);
    let slots = blocks.len() * SLOTS;
    let wanted = slots * points * reads.rows();
    if outcome.state.len() != wanted || outcome.contacts.len() != slots {
        return Err(format!(
            "simulation on a device: found {} numbers and {} guides; must be {wanted} and {slots}",
            outcome.state.len(),
            outcome.contacts.len()
        ));
    }
    let count = blocks.len();
    blocks.par_iter_mut().enumerate().for_each(|(b, block)| {
        accept_block(block, ending, |block| {
            rows::read_state(block, b, count, &outcome.state);
            block.outcome = contacts(block, &outcome.contacts[b * SLOTS..][..SLOTS]);
        });
    });
    Ok(blocks.iter().all(|block| block.outcome.recovered == 0))
}

/// The outcome of a block by the contacts of its slots.
fn contacts(block: &Block, slots: &[SlotContact]) -> Outcome {
    let mut out = Outcome::default();
    for (slot, &guide) in slots.iter().zip(&block.guides).take(block.used) {
        // False for NaN.
        if slot.depth_m > out.deepest.metres {
            out.deepest = Depth { metres: slot.depth_m, point: slot.point, collider: slot.collider };
            out.deepest_guide = guide;
        }
        out.unsure += slot.unsure;
        if slot.unsure > 0 {
            out.first_unsure.get_or_insert((guide, slot.first_unsure));
        }
    }
    out
}
