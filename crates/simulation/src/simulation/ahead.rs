//! Steps that a device does while the caller goes on.
//!
//! Between [`Simulation::begin_on`] and [`Simulation::finish`] the simulation must not be used. Of such a step only positions and velocities
//! are read back; the rest of the state stays on the device until something else goes on with it ([`Simulation::complete`]).

use glam::Vec3;
use rayon::prelude::*;

use super::Simulation;
use crate::block::Block;
use crate::device::{self, DeviceOutcome, Reads, Stamp, StepDevice};
use crate::lanes::Map;
use crate::motion::{HeadPose, rigid_between};
use crate::solver::Ending;
use crate::{RepulsionMode, SimulationSettings, StepInput, StepReport};

/// The report of a step, and why a device did not do it.
pub(super) type Stepped = (StepReport, Option<String>);

/// What does a step.
pub(super) enum Host<'a> {
    Cpu,
    /// A device, and the CPU if it cannot. The whole state is read back.
    Device(&'a mut dyn StepDevice),
    /// A device that only begins the step. Positions and velocities are read back.
    Ahead(&'a mut dyn StepDevice),
}

impl Host<'_> {
    pub(super) fn device(&mut self) -> Option<&mut dyn StepDevice> {
        match self {
            Self::Cpu => None,
            Self::Device(device) | Self::Ahead(device) => Some(&mut **device),
        }
    }

    pub(super) fn reads(&self) -> Reads {
        if matches!(self, Self::Ahead(_)) { Reads::Motion } else { Reads::State }
    }
}

/// A step that a device has begun.
#[derive(Clone, Debug)]
pub(super) struct Begun {
    pub(super) ending: Ending,
    pub(super) substeps: u32,
    pub(super) mode: RepulsionMode,
    /// The head at the start of the step.
    pub(super) before: HeadPose,
}

/// What a device has measured in the density grid.
pub(super) struct Measured {
    over_dense_cells: u32,
    fullness: u32,
}

impl Measured {
    pub(super) fn of(outcome: &DeviceOutcome) -> Self {
        Self { over_dense_cells: outcome.over_dense_cells, fullness: outcome.fullness }
    }
}

impl Simulation {
    /// Begins a step as [`Simulation::step_on`] does it, for [`Simulation::finish`] to end. Returns its result at once if it needs no
    /// device or the device refuses it.
    pub fn begin_on(
        &mut self,
        device: &mut dyn StepDevice,
        input: &StepInput,
        settings: &SimulationSettings,
        dt_secs: f32,
    ) -> Option<(StepReport, Option<String>)> {
        self.step_by(Host::Ahead(device), input, settings, dt_secs)
    }

    /// Waits for the step that `device` has begun; `None` if there is none. If the device cannot end it, the second value says why, and the
    /// hair has moved with the head.
    pub fn finish(&mut self, device: &mut dyn StepDevice) -> Option<(StepReport, Option<String>)> {
        let begun = self.begun.take()?;
        let accepted = device.finish().and_then(|out| {
            let is_whole = device::accept(&mut self.blocks, &begun.ending, out, Reads::Motion)?;
            Ok((is_whole, Measured::of(out)))
        });
        match accepted {
            Ok((is_whole, measured)) => {
                self.is_partial = true;
                if !is_whole {
                    // Guides that were reset differ from those of the device.
                    self.complete_on(Some(device));
                    self.stamps.state = Stamp::new();
                }
                Some((self.report_of(&begun, &measured), None))
            }
            Err(reason) => {
                let by = Map { shift: Vec3::ZERO, ..rigid_between(&begun.before, &self.head, Vec3::ZERO) };
                self.blocks.par_iter_mut().for_each(|block| block.move_rigidly(&by));
                rebuild(&mut self.blocks, &self.head);
                (self.is_partial, self.stamps.state) = (false, Stamp::new());
                Some((StepReport { substeps: begun.substeps, ..StepReport::default() }, Some(reason)))
            }
        }
    }

    /// Reads what only `device` has of the state, so that something else can go on with it. Without a device that has it, it is computed
    /// from the positions.
    pub fn complete(&mut self, device: Option<&mut dyn StepDevice>) {
        if self.is_partial {
            self.complete_on(device);
        }
    }

    /// Identifies positions and velocities: a device that holds this state has the same ones.
    pub fn state_stamp(&self) -> Stamp {
        self.stamps.state
    }

    pub(super) fn complete_on(&mut self, device: Option<&mut dyn StepDevice>) {
        self.is_partial = false;
        let holder = device.filter(|device| device.holds(self.stamps.state));
        let count = self.blocks.len();
        if let Some(Ok(state)) = holder.map(|device| device.read_state()) {
            let blocks = self.blocks.par_iter_mut().enumerate();
            blocks.for_each(|(b, block)| device::read_rest(block, b, count, state));
        } else {
            rebuild(&mut self.blocks, &self.head);
            self.stamps.state = Stamp::new();
        }
    }

    /// Whether `host` can go on from a state that it holds and only it has.
    pub(super) fn goes_on(&self, host: &Host, input: &StepInput, settings: &SimulationSettings) -> bool {
        let Host::Ahead(device) = host else { return false };
        let same_field = match (&self.field, input.field) {
            (Some(field), Some(placed)) => field.is(placed.field, placed.pose.lift),
            (_, placed) => placed.is_none(),
        };
        same_field
            && self.colliders.len() == input.colliders.len()
            && self.clamped_links == settings.clamped_links
            && device.holds(self.stamps.state)
    }

    pub(super) fn report_of(&self, begun: &Begun, measured: &Measured) -> StepReport {
        let (hair_volume, hair_volume_at_rest) = self.grid.volumes(begun.mode, measured.fullness);
        let (substeps, over_dense_cells) = (begun.substeps, measured.over_dense_cells);
        let all = self.outcome(begun.ending.first_free);
        StepReport { substeps, over_dense_cells, hair_volume, hair_volume_at_rest, ..all }
    }
}

/// Computes what moves beside positions and velocities from the positions: links keep their rotations, and contacts are found again.
pub(super) fn rebuild(blocks: &mut [Block], head: &HeadPose) {
    let from_head = head.map_from_head(head.place);
    blocks.par_iter_mut().for_each(|block| block.rebuild(&from_head));
}
