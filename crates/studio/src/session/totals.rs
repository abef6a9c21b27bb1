//! The worst of many steps.

use glam::Vec3;
use lovelock_simulation::{InsidePoint, StepReport};
use serde::Serialize;

/// When and where a point of the hair was as it was found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Found {
    /// Where the timeline stood, seconds from its start; none where there is none, because the body rests.
    pub at_secs: Option<f64>,
    /// Where the point was, world space, metres.
    pub place: Vec3,
}

/// The worst of all steps since the hair was last settled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Steps taken.
    pub steps: u64,
    /// Largest relative change of a link's length.
    pub max_stretch: f32,
    /// The guide whose link that is, and the point at its end.
    pub worst_stretch_at: Option<(u32, u32)>,
    /// When and where that point was.
    pub worst_stretch_found: Option<Found>,
    /// Deepest point inside a collider, metres.
    pub max_penetration_m: f32,
    /// Which point that was; none where no point was inside.
    pub deepest: Option<InsidePoint>,
    /// When and where it was.
    pub deepest_found: Option<Found>,
    /// The most points in one step that were in folded skin, of which nobody knows how deep they are.
    pub unsure_points: u32,
    /// The first of them, its guide and its number.
    pub unsure_at: Option<(u32, u32)>,
    /// When and where that point was.
    pub unsure_found: Option<Found>,
    /// Largest mean kinetic energy, joules per kilogram.
    pub max_kinetic_energy: f32,
    /// The fastest guide and its point in that step.
    pub fastest_at: Option<(u32, u32)>,
    /// When and where that point was.
    pub fastest_found: Option<Found>,
    /// Guides put back to where they began a step, counted at each step.
    pub recovered_guides: u64,
    /// The guide that was put back last.
    pub recovered_at: Option<u32>,
    /// When that was, and where the guide's tip was then.
    pub recovered_found: Option<Found>,
    /// Steps at which the motion jumped.
    pub jumps: u64,
}

impl Totals {
    /// Takes in a step after which the timeline, where there is one, stands at `at_secs`; `place` tells where a point of a guide is.
    pub(super) fn add(
        &mut self,
        report: &StepReport,
        at_secs: Option<f64>,
        place: impl Fn(u32, u32) -> Option<Vec3>,
    ) {
        let found = |(guide, point)| place(guide, point).map(|place| Found { at_secs, place });
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
