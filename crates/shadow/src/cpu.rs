//! What every shadow method does on the processor.

use glam::{Mat4, Vec3};
use lovelock_groom::Strands;

use crate::{LightFrame, RayStructure, ShadowError, ShadowSettings};

/// What a map is built from.
#[derive(Clone, Copy, Debug)]
pub struct ShadowInput<'a> {
    /// The strands that cast the shadow, world space.
    pub strands: &'a Strands,
    /// Width with which one strand blocks light: the diameter of a hair times the number of real hairs that a
    /// strand stands for, metres. See `HairLook::shadow_width`.
    pub strand_width: f32,
    /// The light's direction and axes.
    pub light: LightFrame,
    /// The point that the map's lattice is locked to, world space: the head. Hair that moves along with it
    /// keeps its cells, so its shadow does not swim.
    pub anchor: Vec3,
    /// How many maps are built together, one a light: the memory limit is shared between them evenly. 0 is as 1.
    pub maps: u32,
}

impl ShadowInput<'_> {
    /// What one of the maps may take of a limit for all of them.
    pub(crate) fn share_of(&self, limit_bytes: u64) -> u64 {
        limit_bytes / u64::from(self.maps.max(1))
    }
}

/// What a build cost and met. Times are the caller's to take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShadowReport {
    /// Memory that the map holds, bytes of address space.
    pub memory_bytes: u64,
    /// Cells (or texels) that the build wrote; empty space is skipped.
    pub cells_touched: u64,
    /// Cells (or texels) of the whole map.
    pub cells_total: u64,
    /// Edge of one cell, metres; 0 where the method has none.
    pub cell_size: f32,
    /// Pieces of strand that were put into the map.
    pub samples: u64,
    /// Points left out because they are not finite or too far from the anchor.
    pub points_ignored: u64,
    /// Memory beside the map that builds alone use, kept from build to build, bytes.
    pub scratch_bytes: u64,
    /// Most memory that the map and its build may need, as counted before any was taken and held against the limit,
    /// bytes; 0 where the method has no limit.
    pub needed_bytes: u64,
}

/// What lies behind the whole hair, for surfaces far behind it (the ground): transmittance a light column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnMap {
    /// Texels along each edge.
    pub size: u32,
    /// `size * size` transmittances, row after row; a row runs along u. Texels at the border are 1, so that
    /// clamping at the edge leaves everything beside the map lit.
    pub transmittance: Vec<f32>,
    /// World position to `(u, v, depth)`: u and v in `0..1` over the map with texel centres at
    /// `(i + 0.5) / size`, depth along the light in `0..1` over the map's extent.
    pub uv_from_world: Mat4,
}

/// A shadow method on the processor: the definition of the method.
pub trait CpuShadow {
    /// Makes the map of the strands as they lie now. Memory is reused from build to build.
    ///
    /// # Errors
    /// [`ShadowError::TooLarge`] where the map would take more memory than the method may use; nothing of that
    /// size is allocated, and everything is lit then.
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), ShadowError>;

    /// How much light reaches `p` (world space, metres) through the hair, `0..=1`. Points before the hair or
    /// beside it get 1; a point that is not finite gets 1.
    fn transmittance(&self, p: Vec3) -> f32;

    /// [`CpuShadow::transmittance`] of many points, in parallel. All slices have the same length.
    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]);

    /// What the last build cost and met.
    fn report(&self) -> ShadowReport;

    /// What lies behind the whole hair along the light; `None` where the method cannot say or casts nothing.
    fn column_map(&self) -> Option<ColumnMap>;

    /// What the last build keeps along the light through `p` (world space, metres), to be looked at.
    fn along_ray(&self, p: Vec3) -> RayStructure;
}
