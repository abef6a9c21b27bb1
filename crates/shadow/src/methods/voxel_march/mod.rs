//! `voxel-march`: one grid of density along the axes of the world for all lights, stored only where there is hair, through which points
//! march to the light (hair strands of Unreal Engine).
//!
//! 1. Every sample of a strand adds its optical depth to the cell that contains it. Cells are stored in bricks of 8³, of which those
//!    without hair are absent. The direction of a strand is not stored: each piece counts with the mean over all directions, π/4 of its
//!    length, because the grid serves lights from everywhere.
//! 2. A point steps toward the light, reads the density between the centres of cells at the middle of each step, and adds it up.

mod bricks;
mod cpu;
mod gpu;
mod grid;
mod lattice;
mod march;
mod table;

pub use cpu::VoxelMarch;
pub use lattice::Lattice;

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::TexelFrame;
use crate::{Bounds, RayMarkKind, ShadowInput, ShadowSettings};

pub(super) static METHOD: Method = Method {
    id: "voxel-march",
    label: "Voxel march",
    description: "One sparse grid of density for all lights, through which each point steps to the light (Unreal Engine).",
    source: Some("Epic Games 2020, Unreal Engine: hair strands and their voxels"),
    advice: "lower the map's resolution, or raise the limit",
    map: MapKind::Cells,
    size: |settings| Some(MapSize { edge: settings.voxel_march.resolution, per_texel: None }),
    // A brick of 8³ cells holds 9³ numbers.
    words: |_| 2,
    marks: &[STEP],
    settings: |settings| Some(&settings.voxel_march),
    footprint,
    counts_points: |_| false,
    sums_strands: true,
    in_world: true,
    cpu: || Box::new(VoxelMarch::default()),
    gpu: |_, gpu, _| Ok(Box::new(gpu::GpuVoxelMarch::new(gpu)?)),
    shaders: gpu::GpuVoxelMarch::shaders,
};

/// A step of the march.
pub(crate) const STEP: RayMarkKind = RayMarkKind { label: "Step", resolves_depth: true };

/// Texels as large as cells. Of projected hair, whose extent in the world is not known, as many across it as there are cells.
fn footprint(input: &ShadowInput, settings: &ShadowSettings, bounds: &Bounds) -> TexelFrame {
    let VoxelMarchSettings { resolution, .. } = settings.voxel_march.clamped();
    let placed = (input.light, input.anchor);
    if input.projected.is_some() {
        return TexelFrame::place(placed, 0.0, resolution.max(64), bounds);
    }
    let lattice = Lattice::new(input.anchor, resolution, &lattice::extent(input));
    let across = (bounds.max - bounds.min).max_element().max(0.0) / lattice.cell_size;
    TexelFrame::with_texel_size(placed, (across as u32 + 4).next_multiple_of(16), lattice.cell_size, bounds)
}

/// Settings of the march through voxels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct VoxelMarchSettings {
    /// Cells along the longest edge of the hair, a multiple of 8.
    pub resolution: u32,
    /// Length of a step, cells.
    pub step: f32,
    /// Whether each point starts at a place of its own within the first step, which turns stairs into noise.
    pub jitter: bool,
    /// The most memory that the grid may use, bytes. Hair that needs more is an error.
    pub memory_limit_bytes: u64,
}

impl Default for VoxelMarchSettings {
    fn default() -> Self {
        Self { resolution: 128, step: 1.0, jitter: false, memory_limit_bytes: 1 << 30 }
    }
}
