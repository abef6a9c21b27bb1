//! Worst values over many steps.

use glam::Vec3;
use lovelock_simulation::{InsidePoint, StepReport};
use serde::Serialize;

/// Time and position of a point of the hair when a value occurred.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Occurrence {
    /// Position on the timeline, seconds; `None` if there is no timeline because the body is at rest.
    pub at_secs: Option<f64>,
    /// Position of the point, world space, metres.
    pub place: Vec3,
}

/// Worst values of all steps since the hair was last settled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Number of steps.
    pub steps: u64,
    /// Largest relative change of a link's length.
    pub max_stretch: f32,
    /// Guide and end point of that link.
    pub worst_stretch_at: Option<(u32, u32)>,
    /// Time and position of that point.
    pub worst_stretch_found: Option<Occurrence>,
    /// Deepest point inside a collider, metres.
    pub max_penetration_m: f32,
    /// That point; `None` if no point was inside.
    pub deepest: Option<InsidePoint>,
    /// Time and position of that point.
    pub deepest_found: Option<Occurrence>,
    /// Largest number of points in folded skin in one step. Their penetration depth is unknown.
    pub unsure_points: u32,
    /// Guide and point number of the first of them.
    pub unsure_at: Option<(u32, u32)>,
    /// Time and position of that point.
    pub unsure_found: Option<Occurrence>,
    /// Largest mean kinetic energy, joules per kilogram.
    pub max_kinetic_energy: f32,
    /// The fastest guide and its point in that step.
    pub fastest_at: Option<(u32, u32)>,
    /// Time and position of that point.
    pub fastest_found: Option<Occurrence>,
    /// Number of guides that were reset to the start of a step, summed over all steps.
    pub recovered_guides: u64,
    /// The guide that was reset last.
    pub recovered_at: Option<u32>,
    /// Time of the reset and position of the guide's tip.
    pub recovered_found: Option<Occurrence>,
    /// Number of steps at which the motion jumped.
    pub jumps: u64,
}

impl Totals {
    /// Adds a step. `at_secs` is the position on the timeline after it, if there is a timeline; `place` returns the position of a
    /// guide point.
    pub(super) fn add(
        &mut self,
        report: &StepReport,
        at_secs: Option<f64>,
        place: impl Fn(u32, u32) -> Option<Vec3>,
    ) {
        let found = |(guide, point)| place(guide, point).map(|place| Occurrence { at_secs, place });
        self.steps += 1;
        if report.max_stretch > self.max_stretch {
            (self.max_stretch, self.worst_stretch_at) = (report.max_stretch, report.worst_stretch_at);
            self.worst_stretch_found = report.worst_stretch_at.and_then(found);
        }
        if report.max_penetration_m > self.max_penetration_m {
            (self.max_penetration_m, self.deepest) = (report.max_penetration_m, report.deepest);
            self.deepest_found = report.deepest.and_then(|inside| found((inside.guide, inside.point)));
        }
        if report.unsure_points > self.unsure_points {
            (self.unsure_points, self.unsure_at) = (report.unsure_points, report.unsure_at);
            self.unsure_found = report.unsure_at.and_then(found);
        }
        if report.kinetic_energy > self.max_kinetic_energy {
            (self.max_kinetic_energy, self.fastest_at) = (report.kinetic_energy, report.fastest_at);
            self.fastest_found = report.fastest_at.and_then(found);
        }
        self.recovered_guides += u64::from(report.recovered_guides);
        if let Some(guide) = report.recovered_at {
            self.recovered_at = Some(guide);
            self.recovered_found = found((guide, u32::MAX));
        }
        self.jumps += u64::from(report.jumped);
    }
}
