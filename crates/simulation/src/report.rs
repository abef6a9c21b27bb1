//! Measurements of a step.

use serde::{Deserialize, Serialize};

/// Measured in one step; every number refers to that step alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    /// Number of substeps.
    pub substeps: u32,
    /// Largest relative change of a link's length at the end of the step: 0.001 is 0.1 %. For links shorter
    /// than a millimetre the change is divided by a millimetre.
    pub max_stretch: f32,
    /// Deepest penetration into a collider or the field, beyond what the rest shape allows, metres.
    pub max_penetration_m: f32,
    /// The point with that penetration; `None` if no point is inside.
    pub deepest: Option<InsidePoint>,
    /// Points near folded skin whose position is only a guess. They are pushed out a little, their depth is
    /// unknown, and they do not count in `max_penetration_m`.
    #[serde(default)]
    pub unsure_points: u32,
    /// Guide and point index of the first of those.
    #[serde(default)]
    pub unsure_at: Option<(u32, u32)>,
    /// Guides that were not finite and were reset to their state at the beginning of the step.
    pub recovered_guides: u32,
    /// Cells of the density grid above their threshold at the start of the step.
    pub over_dense_cells: u32,
    /// Volume that the hair fills at the start of the step, cubic metres: the sum over the cells of the
    /// density grid, each weighted by its density relative to the typical density at rest, at most 1.
    pub hair_volume: f32,
    /// The same volume at rest.
    pub hair_volume_at_rest: f32,
    /// Mean kinetic energy of the free points in world space, joules per kilogram.
    pub kinetic_energy: f32,
    /// Speed of the fastest point, metres per second, world space.
    pub max_speed: f32,
    /// The guide whose link has `max_stretch`, and the point at the end of that link.
    #[serde(default)]
    pub worst_stretch_at: Option<(u32, u32)>,
    /// The guide and point with `max_speed`.
    #[serde(default)]
    pub fastest_at: Option<(u32, u32)>,
    /// The first of the guides that were reset.
    #[serde(default)]
    pub recovered_at: Option<u32>,
    /// Whether the motion jumped, so that the hair was moved with the head and not simulated.
    pub jumped: bool,
}

/// A point of the hair inside the body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InsidePoint {
    /// Index of the guide in the hairstyle.
    pub guide: u32,
    /// Index of the point, counted from the root.
    pub point: u32,
    /// Penetration depth, metres.
    pub depth_m: f32,
    /// The part of the body that contains the point.
    pub within: BodyPart,
}

/// What hair collides with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BodyPart {
    /// One of [`crate::StepInput::colliders`], by index.
    Collider(u32),
    /// The field of head and shoulders.
    Field,
}

impl BodyPart {
    pub(crate) fn of(collider: u32) -> Self {
        if collider == crate::colliders::contact::FIELD { Self::Field } else { Self::Collider(collider) }
    }
}
