//! The content of a map along one ray of its light, for inspection.

use std::fmt;

/// A kind of piece that a map holds: a slice, a bin, a fragment. Each method's folder names its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RayMarkKind {
    /// The name in the interface.
    pub label: &'static str,
    /// Whether the method resolves depth down to pieces of this kind: then their thickness is what banding shows.
    pub resolves_depth: bool,
}

impl RayMarkKind {
    /// One fragment of the hair: a step.
    pub const FRAGMENT: Self = Self { label: "Fragment", resolves_depth: false };
}

impl fmt::Display for RayMarkKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.label)
    }
}

/// One piece of a map along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayMark {
    /// Its kind.
    pub kind: RayMarkKind,
    /// Its start, metres along the light from the point; negative before the point.
    pub start: f32,
    /// Its end; the same as `start` for a step.
    pub end: f32,
    /// Its optical depth.
    pub optical_depth: f32,
    /// Unfiltered transmittance behind it in this column, 0 to 1.
    pub transmittance: f32,
}

/// The content of the texel or the column of cells that contains a point. Pieces of one kind are together, sorted by depth.
///
/// Filters also read the columns around it: the *result* of the method along the ray is
/// [`CpuShadow::transmittance`](crate::CpuShadow::transmittance) at points on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayStructure {
    /// The pieces. Empty if the column contains no hair, beside the map, for a point that is not finite, and before the first
    /// build.
    pub marks: Vec<RayMark>,
}
