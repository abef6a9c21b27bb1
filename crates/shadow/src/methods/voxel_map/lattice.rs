//! The placement of the map's cells in the world.
//!
//! The cells are a window of `N × N × N` cubes on an infinite lattice along the light's axes, one corner of which is the
//! anchor. The window follows the hair; the lattice follows only the anchor.

use glam::{IVec3, Mat4, Vec3, Vec4};
use lovelock_base::settings::Settings;
use lovelock_groom::Strands;

use super::{MapExtent, VoxelMapSettings};
use crate::bounds::{Bounds, FARTHEST, SMALLEST_CELL, round_up_to_step};
use crate::{LightFrame, ShadowInput};

/// Cells along each edge that hair cannot use: an empty one on each side, and one because the bounds of the hair may start
/// between two corners of the lattice.
const SPARE_CELLS: u32 = 3;

/// The window of cells and the transform from world space into it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Cells along each edge, *N*.
    pub resolution: u32,
    /// Edge of a cell, *ds*, metres.
    pub cell_size: f32,
    /// The fixed corner of the lattice, world space.
    pub anchor: Vec3,
    /// The light's axes divided by the size of a cell: dot products with them are in cells.
    pub axes_per_cell: [Vec3; 3],
    /// Lattice coordinates of the first cell of the window (the paper's *i* min, and likewise for *j* and *k*).
    pub first: IVec3,
}

impl Lattice {
    /// The window for hair within `bounds`.
    ///
    /// The size of a cell is rounded up to a sixteenth of an octave, so that it stays the same from frame to frame while the
    /// extent of the hair changes little.
    pub fn new(input: &ShadowInput, settings: &VoxelMapSettings, bounds: &Bounds) -> Self {
        Self::place((input.light, input.anchor), || longest(input), settings, bounds)
    }

    /// [`Lattice::new`] for strands in GPU memory. `longest_strand` is called only where the extent depends on it.
    pub(crate) fn place(
        (light, anchor): (LightFrame, Vec3),
        longest_strand: impl FnOnce() -> f32,
        settings: &VoxelMapSettings,
        bounds: &Bounds,
    ) -> Self {
        let VoxelMapSettings { resolution, extent, head_size, .. } = settings.clamped();
        let (min, max) =
            if bounds.min.x <= bounds.max.x { (bounds.min, bounds.max) } else { (Vec3::ZERO, Vec3::ZERO) };
        let fitting = (max - min).max_element() / (resolution - SPARE_CELLS) as f32;
        let wanted = match extent {
            MapExtent::Fit => fitting,
            MapExtent::Paper => {
                let longest = longest_strand().clamp(0.0, FARTHEST);
                let edge = 2.0 * longest + head_size;
                fitting.max(edge / resolution as f32)
            }
        };
        // Lattice coordinates stay below 2^16, where f32 still resolves a hundredth of a cell.
        let farthest = min.abs().max(max.abs()).max_element();
        let cell_size = round_up_to_step(wanted.max(SMALLEST_CELL).max(farthest / 65_536.0));
        let per_cell = 1.0 / cell_size;
        let (low, high) = ((min * per_cell).floor().as_ivec3(), (max * per_cell).floor().as_ivec3());
        // Cells that the hair does not need are split evenly between both sides.
        let spare = (IVec3::splat(resolution as i32) - (high - low + 1)).max(IVec3::ZERO);
        Self {
            resolution,
            cell_size,
            anchor,
            axes_per_cell: [light.x * per_cell, light.y * per_cell, light.z * per_cell],
            first: low - spare / 2,
        }
    }

    /// Coordinates of `p` on the infinite lattice, in cells from the anchor.
    pub fn lattice_from_world(&self, p: Vec3) -> Vec3 {
        let d = p - self.anchor;
        Vec3::from(self.axes_per_cell.map(|axis| d.x * axis.x + d.y * axis.y + d.z * axis.z))
    }

    /// Coordinates of `p` in the window, in cells; the integer part is the cell.
    pub fn window_from_world(&self, p: Vec3) -> Vec3 {
        self.lattice_from_world(p) - self.first.as_vec3()
    }

    /// World position to `(u, v, depth)` of a [`ColumnMap`](crate::ColumnMap), whose rows run along the second axis across
    /// the light.
    pub(crate) fn uv_from_world(&self) -> Mat4 {
        let n = self.resolution as f32;
        let first = self.first.as_vec3();
        let row = |axis: usize| {
            let per_map = self.axes_per_cell[axis] / n;
            per_map.extend(-per_map.dot(self.anchor) - first[axis] / n)
        };
        Mat4::from_cols(row(2), row(1), row(0), Vec4::W).transpose()
    }

    /// Whether a point in window coordinates was included in the bounds of the window: it is finite and not too far away.
    pub fn holds(&self, p: Vec3) -> bool {
        p.abs().cmple(Vec3::splat(2.0 * self.resolution as f32)).all()
    }

    /// The paper's mapping Ψ: the cell of `p` in a map addressed modulo *N*, so that the window can slide over the lattice
    /// without moving stored cells.
    ///
    /// This uses the floor and the Euclidean modulus; truncation would be off by one cell below zero.
    pub fn psi(&self, p: Vec3) -> [usize; 3] {
        self.wrapped(self.lattice_from_world(p).floor().as_ivec3())
    }

    /// The place of a lattice cell in a map addressed modulo *N*.
    pub fn wrapped(&self, cell: IVec3) -> [usize; 3] {
        cell.to_array().map(|c| c.rem_euclid(self.resolution as i32) as usize)
    }
}

/// The longest strand that casts the shadow, metres.
fn longest(input: &ShadowInput) -> f32 {
    input.projected.map_or_else(|| longest_strand(input.strands), |projected| projected.longest_strand)
}

/// The largest sum of segment lengths of a strand, metres. Strands that are not finite are ignored.
pub fn longest_strand(strands: &Strands) -> f32 {
    let ends = strands.first_point.windows(2).map(|ends| ends[0] as usize..ends[1] as usize);
    let length = |range: std::ops::Range<usize>| -> f32 {
        range.clone().zip(range.skip(1)).map(|(a, b)| strands.point(a).distance(strands.point(b))).sum()
    };
    ends.map(length).filter(|length| *length < FARTHEST).fold(0.0, f32::max)
}
