//! What a step has to say about itself.

use serde::{Deserialize, Serialize};

/// Measured in one step. Every number is of that step alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    /// Substeps taken.
    pub substeps: u32,
    /// Largest relative change of a link's length at the end of the step: 0.001 is 0.1 %.
    pub max_stretch: f32,
    /// Deepest point inside a collider, beyond what its place at rest allows, metres.
    pub max_penetration_m: f32,
    /// Guides that were not finite and were put back to their last good pose.
    pub recovered_guides: u32,
    /// Cells of the density grid above their threshold at the start of the step.
    pub over_dense_cells: u32,
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
