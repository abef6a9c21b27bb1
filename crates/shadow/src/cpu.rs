//! The interface of shadow methods on the CPU.

use glam::{Mat4, Vec3};
use lovelock_groom::Strands;

use crate::{LightFrame, RayStructure, ShadowError, ShadowSettings};

/// The input of a build.
#[derive(Clone, Copy, Debug)]
pub struct ShadowInput<'a> {
    /// The strands that cast the shadow, world space.
    pub strands: &'a Strands,
    /// The width with which one strand blocks light, metres: the diameter of a hair times the number of real hairs that a
    /// strand represents. See `HairLook::shadow_width`.
    pub strand_width: f32,
    /// Factor on the optical depth of every strand; see `HairLook::extinction_scale`. Negative values and NaN count as 0.
    pub extinction_scale: f32,
    /// The light's direction and axes.
    pub light: LightFrame,
    /// The origin of the map's lattice, world space: the head. Hair that moves with it stays in its cells, so that its shadow
    /// does not flicker.
    pub anchor: Vec3,
    /// The number of maps that are built together, one per light. They share the memory limit evenly. 0 counts as 1.
    pub maps: u32,
}

/// A factor on optical depth in its usable range: not negative, finite, and 0 for NaN.
pub(crate) fn safe_extinction(scale: f32) -> f32 {
    if scale > 0.0 { scale.min(1e6) } else { 0.0 }
}

impl ShadowInput<'_> {
    /// The share of one map in a limit for all of them.
    pub(crate) fn share_of(&self, limit_bytes: u64) -> u64 {
        limit_bytes / u64::from(self.maps.max(1))
    }
}

/// Statistics of a build, without times, which the caller measures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShadowReport {
    /// Memory of the map, bytes of address space.
    pub memory_bytes: u64,
    /// Cells (or texels) that the build wrote. Empty space is skipped.
    pub cells_touched: u64,
    /// Cells (or texels) of the whole map.
    pub cells_total: u64,
    /// Edge of a cell (or texel), metres; 0 if the method has no map.
    pub cell_size: f32,
    /// Samples (or fragments) of strands that were added to the map.
    pub samples: u64,
    /// Points that were ignored because they are not finite or too far from the anchor.
    pub points_ignored: u64,
    /// Memory that only builds use, kept from build to build, bytes.
    pub scratch_bytes: u64,
    /// The most memory that the map and its build may need, bytes: computed before any is allocated, and compared with the limit.
    /// 0 if the method has no limit.
    pub needed_bytes: u64,
}

/// The transmittance behind the whole hair, for surfaces far behind it (the ground).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnMap {
    /// Texels along each edge.
    pub size: u32,
    /// `size * size` transmittances, row after row; rows run along u. Texels at the border are 1, so that clamped coordinates
    /// outside the map are lit.
    pub transmittance: Vec<f32>,
    /// World position to `(u, v, depth)`: u and v in `0..1` over the map with texel centres at
    /// `(i + 0.5) / size`, depth along the light in `0..1` over the map's extent.
    pub uv_from_world: Mat4,
}

/// A shadow method on the CPU. It defines the method; the GPU must agree with it.
pub trait CpuShadow {
    /// Builds the map of the strands. Memory is reused from build to build.
    ///
    /// # Errors
    /// [`ShadowError::TooLarge`] if the map would exceed the memory limit of the method. Then nothing of that size is allocated,
    /// and everything is lit.
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), ShadowError>;

    /// The transmittance at `p` (world space, metres), `0..=1`: the fraction of the light that the hair lets through. It is 1
    /// before and beside the hair, and for points that are not finite.
    fn transmittance(&self, p: Vec3) -> f32;

    /// [`CpuShadow::transmittance`] of many points, in parallel. All slices have the same length.
    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]);

    /// Statistics of the last build.
    fn report(&self) -> ShadowReport;

    /// The transmittance behind the whole hair; `None` before the first build and if the method casts no shadow.
    fn column_map(&self) -> Option<ColumnMap>;

    /// What the last map holds along the light through `p` (world space, metres), for inspection.
    fn along_ray(&self, p: Vec3) -> RayStructure;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extinction_is_always_a_usable_number() {
        let cases = [(0.15, 0.15), (0.0, 0.0), (-1.0, 0.0), (f32::NAN, 0.0), (f32::INFINITY, 1e6)];
        for (scale, safe) in cases {
            assert_eq!(safe_extinction(scale), safe);
        }
    }
}
