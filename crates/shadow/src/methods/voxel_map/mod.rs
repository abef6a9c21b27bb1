//! `voxel-map`: a grid of density whose first axis runs along the light (Bertails, Ménier, Cani 2005,
//! "A Practical Self-Shadowing Algorithm for Interactive Hair Animation").
//!
//! 1. Every sample of a strand adds its optical depth to the cell that contains it.
//! 2. Each column of cells is summed along the light: a cell holds the sum up to and including itself, which belongs to its
//!    *back face*.
//! 3. A point reads the four columns around it. It interpolates optical depth along the light and transmittance across it.
//!
//! `docs/shadow_methods.md` has the equations and explains where they differ from the printed paper. The plain version is in
//! [`mod@reference`]; [`VoxelMap`] is the fast version of the same map.

mod adaptive;
mod choice;
mod cpu;
mod deposit;
mod free_grids;
mod gpu;
mod grid;
mod lattice;
mod layout;
mod lookup;
mod projected;
pub mod published;
pub mod reference;
mod samples;
mod sum;
mod table;

pub use adaptive::Columns;
use choice::{GpuVoxelShadow, VoxelShadow};
pub use cpu::VoxelMap;
pub use lattice::{Lattice, longest_strand};

pub use crate::bounds::Bounds;

use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{TexelFrame, TexelMethod};
use crate::RayMarkKind;

pub(super) static METHOD: Method = Method {
    id: "voxel-map",
    label: "Voxel map",
    description: "Density of hair in a grid along the light, summed slice by slice (Bertails, Ménier, Cani 2005).",
    source: Some(
        "Bertails, Ménier, Cani 2005, A Practical Self-Shadowing Algorithm for Interactive Hair Animation",
    ),
    advice: "lower the map's resolution or the number of strands",
    map: MapKind::Cells,
    size: |settings| Some(MapSize { edge: settings.voxel_map.resolution, per_texel: None }),
    words: |settings| match settings.voxel_map.slices {
        VoxelSlices::Uniform => 1,
        VoxelSlices::Adaptive => Columns::new(settings).words_per_cell(),
    },
    marks: &[CELL],
    settings: |settings| Some(&settings.voxel_map),
    footprint: |input, settings, bounds| {
        if settings.voxel_map.slices == VoxelSlices::Adaptive {
            return TexelFrame::new(input, Columns::new(settings).resolution(), bounds);
        }
        let Lattice { resolution, cell_size, .. } = Lattice::new(input, &settings.voxel_map, bounds);
        TexelFrame::with_texel_size((input.light, input.anchor), resolution, cell_size, bounds)
    },
    counts_points: |settings| {
        settings.voxel_map.slices == VoxelSlices::Uniform
            && settings.voxel_map.deposit == VoxelDeposit::PointCount
    },
    sums_strands: true,
    in_world: false,
    cpu: || Box::new(VoxelShadow::default()),
    gpu: |_, gpu, projected| Ok(Box::new(GpuVoxelShadow::new(gpu, projected)?)),
    shaders: GpuVoxelShadow::shaders,
};

/// A cell of the column.
pub(crate) const CELL: RayMarkKind = RayMarkKind { label: "Cell", resolves_depth: true };

/// The extent of the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapExtent {
    /// The extent of the hair in the current frame, with an empty cell around it.
    #[default]
    Fit,
    /// The paper's constant bound: twice the longest strand plus the head.
    Paper,
}

/// How a point reads the cells around it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VoxelFilter {
    /// Interpolates optical depth between the faces of a cell along the light, and transmittance between cell centres across it.
    #[default]
    Centred,
    /// As printed: interpolates transmittance on all three axes as if it belonged to the far corner of a cell, which displaces the
    /// shadow by half a cell on both axes across the light.
    Paper,
    /// Reads the cell that contains the point without a filter, as on the left of the paper's figure 5: patterns along the map show.
    Closest,
}

/// What strands add to the cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VoxelDeposit {
    /// The optical depth of each piece of strand by its length across the light, so that a strand seen end-on covers less: the shadow
    /// does not depend on the resolution of the map or on the sampling of strands.
    #[default]
    Length,
    /// The same without orientation: every piece covers as much as the mean over all directions, π/4 of its length.
    Isotropic,
    /// As printed: one per point of a strand, times [`VoxelMapSettings::point_extinction`] and the size of the cell. Depends on both,
    /// with the third power of the size of the cell.
    PointCount,
}

/// Where the cells of a column end along the light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VoxelSlices {
    /// At even distances: cells are cubes.
    #[default]
    Uniform,
    /// Where its hair is: each cell holds an equal share of it. The same memory then has room for twice as many columns along each edge.
    /// The map has the size of the hair, strands add the optical depth of their length, and the filter is centred.
    Adaptive,
}

/// Settings of the voxel map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct VoxelMapSettings {
    /// Cells along each edge, a multiple of 8.
    pub resolution: u32,
    /// Where the cells of a column end along the light.
    pub slices: VoxelSlices,
    /// The extent of the map.
    pub extent: MapExtent,
    /// Size of the head for [`MapExtent::Paper`] (the paper's h with index max), metres.
    pub head_size: f32,
    /// How a point reads the cells around it.
    pub filter: VoxelFilter,
    /// What strands add to the cells.
    pub deposit: VoxelDeposit,
    /// The paper's *f* for [`VoxelDeposit::PointCount`]: extinction per metre that one point adds to a cell,
    /// before the extinction scale.
    pub point_extinction: f32,
}

impl VoxelDeposit {
    /// Factors on the squared lengths of a piece along the light and across it, whose sum is the squared length that counts.
    pub(crate) const fn squares(self) -> [f32; 2] {
        /// The square of the mean of the sine over all directions, π/4.
        const MEAN: f32 = std::f32::consts::FRAC_PI_4 * std::f32::consts::FRAC_PI_4;
        match self {
            Self::Length | Self::PointCount => [0.0, 1.0],
            Self::Isotropic => [MEAN, MEAN],
        }
    }
}

impl Default for VoxelMapSettings {
    fn default() -> Self {
        Self {
            resolution: 128,
            slices: VoxelSlices::default(),
            extent: MapExtent::default(),
            head_size: 0.24,
            filter: VoxelFilter::default(),
            deposit: VoxelDeposit::default(),
            point_extinction: 50.0,
        }
    }
}
