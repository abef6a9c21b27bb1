//! The light along a ray through a chosen hair: where it was asked for, and what each method says.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A place in a pane where somebody asked for the hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbePlace {
    /// Tells askings apart: the hair of one asking is followed while it moves.
    pub number: u64,
    /// From the left of the pane, 0 to 1.
    pub x: f32,
    /// From its top, 0 to 1.
    pub y: f32,
}

/// The light along a ray through the chosen hair.
#[derive(Clone, Debug)]
pub struct LiveProbe {
    /// [`ProbePlace::number`].
    pub number: u64,
    /// The hair; none where there is none at the place.
    pub hair: Option<ProbedHair>,
}

/// A strand's point and the ray of light through it.
#[derive(Clone, Debug)]
pub struct ProbedHair {
    /// The strand.
    pub strand: u32,
    /// Which of its points, from the root.
    pub point: u32,
    /// Where it is, world space, metres.
    pub position: Vec3,
    /// The depths that the curves reach over, metres along the light relative to the point.
    pub range: [f32; 2],
    /// The step function of the exact method: depth, and transmittance from there on.
    pub steps: Vec<(f32, f32)>,
    /// What each pane says, with the pane's number.
    pub curves: Vec<(usize, ProbeCurve)>,
}

/// One method along a ray.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProbeCurve {
    /// Its [`MethodReport::name`].
    pub method: String,
    /// Depth along the light relative to the point, metres, and transmittance there.
    pub curve: Vec<(f32, f32)>,
    /// Transmittance at the point itself.
    pub value: f32,
    /// What the method keeps along the ray.
    pub marks: Vec<ProbeMark>,
}

/// Something that a method keeps on a ray: a slice, a bin of a cluster, a fragment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProbeMark {
    /// `slice`, `layer`, `slab`, `bin`, `cell` or `fragment`.
    pub kind: String,
    /// Where it begins, metres along the light relative to the point.
    pub start: f32,
    /// Where it ends; the same where it has no extent.
    pub end: f32,
    /// Optical depth in it.
    pub weight: f32,
}
