//! The worst of many steps.

use lovelock_wisp::{InsidePoint, StepReport};

/// The worst of all steps since the hair was last settled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Steps taken.
    pub steps: u64,
    /// Largest relative change of a link's length.
    pub max_stretch: f32,
    /// The guide whose link that is, and the point at its end.
    pub worst_stretch_at: Option<(u32, u32)>,
    /// Deepest point inside a collider, metres.
    pub max_penetration_m: f32,
    /// Where that was; none where no point was inside.
    pub deepest: Option<InsidePoint>,
    /// Largest mean kinetic energy, joules per kilogram.
    pub max_kinetic_energy: f32,
    /// The fastest guide and its point in that step.
    pub fastest_at: Option<(u32, u32)>,
    /// Guides put back to their last good pose, counted at each step.
    pub recovered_guides: u64,
    /// The guide that was put back last.
    pub recovered_at: Option<u32>,
    /// Steps at which the motion jumped.
    pub jumps: u64,
}

impl Totals {
    pub(super) fn add(&mut self, report: &StepReport) {
        self.steps += 1;
        if report.max_stretch > self.max_stretch {
            (self.max_stretch, self.worst_stretch_at) = (report.max_stretch, report.worst_stretch_at);
        }
        if report.max_penetration_m > self.max_penetration_m {
            (self.max_penetration_m, self.deepest) = (report.max_penetration_m, report.deepest);
        }
        if report.kinetic_energy > self.max_kinetic_energy {
            (self.max_kinetic_energy, self.fastest_at) = (report.kinetic_energy, report.fastest_at);
        }
        self.recovered_guides += u64::from(report.recovered_guides);
        self.recovered_at = report.recovered_at.or(self.recovered_at);
        self.jumps += u64::from(report.jumped);
    }
}
