//! The interface of shadow methods on the CPU.

use glam::{Mat4, Vec3};
use lovelock_groom::Strands;

use crate::bounds::Bounds;
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
    /// The light's direction and axes, and where it stands.
    pub light: LightFrame,
    /// The origin of the map's lattice, world space: the head. Hair that moves with it stays in its cells, so that its shadow
    /// does not flicker.
    pub anchor: Vec3,
    /// The number of maps that are built together, one per light. They share the memory limit evenly. 0 counts as 1.
    pub maps: u32,
    /// What the strands are if rays that spread from a light were made parallel; `None` for the strands themselves. Only
    /// [`cpu_shadow`](crate::cpu_shadow) and [`converged`](crate::converged) set it.
    pub projected: Option<ProjectedStrands<'a>>,
}

/// What is known of strands that were projected from a light, see [`ShadowInput::projected`].
#[derive(Clone, Copy, Debug)]
pub struct ProjectedStrands<'a> {
    /// A factor on the width of the strand at each point.
    pub widths: &'a [f32],
    /// The bounds within which cells and texels lie, along the axes of [`ShadowInput::light`].
    pub bounds: Bounds,
    /// Length of the longest strand in the world, metres.
    pub longest_strand: f32,
    /// Distance of the plane from the light, metres.
    pub plane: f32,
    /// Distance of depth 0 from the light, metres.
    pub start: f32,
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

    /// The bounds of the strands along the axes of the light, or those that are given.
    pub(crate) fn bounds(&self) -> Bounds {
        self.projected.map_or_else(|| Bounds::of_strands(self), |projected| projected.bounds)
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
    /// Records of the map that cannot be read as the method is defined, and are read in a simpler way: moments of which no distribution
    /// can be computed. On the GPU they are known when the frame has been read; those of soft lights are of one sample, and those of a light that hair surrounds of one side.
    pub fallbacks: u64,
}

/// What to tell about [`ShadowReport::fallbacks`], if there are any.
pub fn fallbacks_sentence(fallbacks: u64) -> Option<String> {
    let texels = if fallbacks == 1 { "1 texel has".to_owned() } else { format!("{fallbacks} texels have") };
    (fallbacks > 0).then(|| {
        format!(
            "{texels} moments that no hair can have; there the hair counts as even. A larger bias avoids it."
        )
    })
}

impl ShadowReport {
    /// The statistics of two maps of one light together.
    #[must_use]
    pub(crate) fn joined(self, other: Self) -> Self {
        Self {
            memory_bytes: self.memory_bytes + other.memory_bytes,
            cells_touched: self.cells_touched + other.cells_touched,
            cells_total: self.cells_total + other.cells_total,
            cell_size: self.cell_size.max(other.cell_size),
            samples: self.samples + other.samples,
            points_ignored: self.points_ignored.max(other.points_ignored),
            scratch_bytes: self.scratch_bytes.max(other.scratch_bytes),
            needed_bytes: self.needed_bytes + other.needed_bytes,
            fallbacks: self.fallbacks + other.fallbacks,
        }
    }
}

/// The transmittance behind the whole hair, for surfaces far behind it (the ground).
///
/// A light that is surrounded by hair has several, one per side of a cube around it. A point belongs to that whose matrix gives
/// it the largest fourth coordinate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnMap {
    /// Texels along each edge.
    pub size: u32,
    /// `size * size` transmittances, row after row; rows run along u. Texels at the border are 1, so that clamped coordinates
    /// outside the map are lit.
    pub transmittance: Vec<f32>,
    /// World position to `(u, v, depth, 1)`: u and v in `0..1` over the map with texel centres at
    /// `(i + 0.5) / size`, depth along the light in `0..1` over the map's extent. Of a light that stands somewhere the fourth
    /// coordinate is the distance along the middle of the map, metres: divided by it, u and v are those of the map; where it is not
    /// positive, the point is behind the light.
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

    /// The same on every side of a light that is surrounded by hair.
    fn column_maps(&self) -> Vec<ColumnMap> {
        self.column_map().into_iter().collect()
    }

    /// The number of fragments before each point (world space, metres) in its texel: how deep it lies in the hair. 0 beside the
    /// map and before the first build; `None` of a method that does not hold them.
    fn fragments_before(&self, _points: &[Vec3]) -> Option<Vec<u32>> {
        None
    }

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
