//! The light along a ray through a chosen strand point: the request, and the transmittance of each method.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A position in a pane where the user picked hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbePlace {
    /// Number of the pick. The picked hair is followed while it moves.
    pub number: u64,
    /// Position from the left of the pane, 0 to 1.
    pub x: f32,
    /// Position from the top of the pane, 0 to 1.
    pub y: f32,
}

/// The light along a ray through the chosen hair.
#[derive(Clone, Debug)]
pub struct LiveProbe {
    /// [`ProbePlace::number`].
    pub number: u64,
    /// The hair; `None` if there is none at the position.
    pub hair: Option<ProbedHair>,
}

/// A strand point and the ray of light through it.
#[derive(Clone, Debug)]
pub struct ProbedHair {
    /// The strand.
    pub strand: u32,
    /// Number of the point, from the root.
    pub point: u32,
    /// Its position, world space, metres.
    pub position: Vec3,
    /// Range of depth of the curves, metres along the light relative to the point.
    pub range: [f32; 2],
    /// The step function of the exact method: depth, and transmittance from there on.
    pub steps: Vec<(f32, f32)>,
    /// The curve of each pane, with the pane's number.
    pub curves: Vec<(usize, ProbeCurve)>,
}

/// One method along a ray.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProbeCurve {
    /// Name of the method in the report.
    pub method: String,
    /// Depth along the light relative to the point, metres, and transmittance there.
    pub curve: Vec<(f32, f32)>,
    /// Transmittance at the point.
    pub value: f32,
    /// What the method stores along the ray.
    pub marks: Vec<ProbeMark>,
}

/// Something that a method stores along a ray, such as a slice, a bin or a fragment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProbeMark {
    /// `slice`, `layer`, `slab`, `bin`, `cell` or `fragment`.
    pub kind: String,
    /// Start, metres along the light relative to the point.
    pub start: f32,
    /// End; equal to the start if it has no extent.
    pub end: f32,
    /// Optical depth in it.
    pub weight: f32,
}
