//! What a step has to say about itself.

use serde::{Deserialize, Serialize};

/// Measured in one step. Every number is of that step alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    /// Substeps taken.
    pub substeps: u32,
    /// Largest relative change of a link's length at the end of the step: 0.001 is 0.1 %. Of links shorter than a millimetre the
    /// change as a part of that.
    pub max_stretch: f32,
    /// Deepest point inside a collider or the field, beyond what its place at rest allows, metres.
    pub max_penetration_m: f32,
    /// Where that point is; `None` where no point is inside.
    pub deepest: Option<InsidePoint>,
    /// Points in folded skin, of which only a guess is known: they are pushed out a little, and nobody knows how deep they
    /// are. They do not count in `max_penetration_m`.
    #[serde(default)]
    pub unsure_points: u32,
    /// The first of those, its guide and its number.
    #[serde(default)]
    pub unsure_at: Option<(u32, u32)>,
    /// Guides that were not finite and were put back to where they began the step.
    pub recovered_guides: u32,
    /// Cells of the density grid above their threshold at the start of the step.
    pub over_dense_cells: u32,
    /// Volume that the hair fills at the start of the step, cubic metres: cells of the density grid, each counted by
    /// how full it is, where hair at rest typically fills a cell, and at most once.
    pub hair_volume: f32,
    /// The same at rest.
    pub hair_volume_at_rest: f32,
    /// Mean kinetic energy of the free points in world space, joules per kilogram.
    pub kinetic_energy: f32,
    /// Fastest point, metres per second, world space.
    pub max_speed: f32,
    /// The guide whose link has `max_stretch`, and the point at that link's end.
    #[serde(default)]
    pub worst_stretch_at: Option<(u32, u32)>,
    /// The guide and its point that has `max_speed`.
    #[serde(default)]
    pub fastest_at: Option<(u32, u32)>,
    /// The first of the guides that were put back.
    #[serde(default)]
    pub recovered_at: Option<u32>,
    /// Whether the motion jumped, so that hair was moved along with the head and not simulated.
    pub jumped: bool,
}

/// A point of the hair inside the body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InsidePoint {
    /// The guide, as the hairstyle counts them.
    pub guide: u32,
    /// Its point, root first.
    pub point: u32,
    /// How deep, metres.
    pub depth_m: f32,
    /// What it is in.
    pub within: BodyPart,
}

/// What hair collides with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BodyPart {
    /// One of [`crate::StepInput::colliders`], by its index.
    Collider(u32),
    /// The field of head and shoulders.
    Field,
}

impl BodyPart {
    pub(crate) fn of(collider: u32) -> Self {
        if collider == crate::colliders::contact::FIELD { Self::Field } else { Self::Collider(collider) }
    }
}
