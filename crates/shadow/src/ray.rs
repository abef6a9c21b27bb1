//! What a map keeps along one ray of its light.

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

/// One piece of what a method keeps along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayMark {
    /// What it is.
    pub kind: RayMarkKind,
    /// Where it begins, metres along the light from the point; below 0 before it.
    pub start: f32,
    /// Where it ends; the same as `start` for a step.
    pub end: f32,
    /// Optical depth that it holds.
    pub optical_depth: f32,
    /// Transmittance behind it, by this column alone, before any filter: 0 to 1.
    pub transmittance: f32,
}

/// What a method keeps in the column (of texels or cells) that a point lies in, by depth; those of one kind together.
///
/// Filters read the columns around it too: what the method *answers* along the ray is
/// [`CpuShadow::transmittance`](crate::CpuShadow::transmittance) at places on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayStructure {
    /// The pieces; none where the column has no hair, beside the map, for a point that is not finite, and before the first
    /// build.
    pub marks: Vec<RayMark>,
}
