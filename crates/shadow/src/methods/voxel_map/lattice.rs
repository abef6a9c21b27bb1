//! Where the map's cells lie in the world.
//!
//! The cells are a window of `N × N × N` on an infinite lattice of cubes along the light's axes, one corner of
//! which is the anchor. The window follows the hair; the lattice follows the anchor alone.
// Bounds are compiled within the versions of `simd`.
#![allow(clippy::inline_always)]

use glam::{IVec3, Vec3};
use lovelock_groom::Strands;

use super::{MapExtent, VoxelMapSettings};
use crate::{LightFrame, ShadowInput};

/// Points farther from the anchor than this on any axis are left out, metres.
const FARTHEST: f32 = 1e4;

/// Smallest cell, metres: hair that has collapsed to a point must not make cells of no size.
const SMALLEST_CELL: f32 = 1e-5;

/// Cells of the window that hair cannot use: an empty one on each side, and one that hair's bounds may cut
/// where they begin between two corners of the lattice.
const SPARE_CELLS: u32 = 3;

/// The hair's extent along the light's axes, relative to the anchor, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates; above `max` where there is no point.
    pub min: Vec3,
    /// Largest coordinates.
    pub max: Vec3,
    /// Points left out because they are not finite or too far away.
    pub ignored: u64,
}

impl Bounds {
    /// Bounds of nothing.
    pub const EMPTY: Self =
        Self { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY), ignored: 0 };

    /// Bounds of points; slices of one length.
    #[inline(always)]
    pub(super) fn of_points(x: &[f32], y: &[f32], z: &[f32], light: &LightFrame, anchor: Vec3) -> Self {
        let mut running = Running::default();
        let (xs, x_rest) = x.as_chunks::<LANES>();
        let (ys, y_rest) = y.as_chunks::<LANES>();
        let (zs, z_rest) = z.as_chunks::<LANES>();
        for ((x, y), z) in xs.iter().zip(ys).zip(zs) {
            running.add([x, y, z], light, anchor);
        }
        // The rest, filled up with points that are ignored.
        let fill = |rest: &[f32]| {
            let mut lanes = [f32::NAN; LANES];
            lanes[..rest.len()].copy_from_slice(rest);
            lanes
        };
        running.add([&fill(x_rest), &fill(y_rest), &fill(z_rest)], light, anchor);
        let mut bounds = running.bounds();
        bounds.ignored -= (LANES - x_rest.len()) as u64;
        bounds
    }

    /// The bounds of both.
    pub fn join(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            ignored: self.ignored + other.ignored,
        }
    }
}

/// Points that are bounded together.
const LANES: usize = 16;

/// Bounds on the way, one for each lane.
struct Running {
    min: [[f32; LANES]; 3],
    max: [[f32; LANES]; 3],
    ignored: [u32; LANES],
}

impl Default for Running {
    fn default() -> Self {
        Self { min: [[f32::INFINITY; LANES]; 3], max: [[f32::NEG_INFINITY; LANES]; 3], ignored: [0; LANES] }
    }
}

impl Running {
    #[inline(always)]
    fn add(&mut self, points: [&[f32; LANES]; 3], light: &LightFrame, anchor: Vec3) {
        let mut along = [[0.0; LANES]; 3];
        let mut near = [true; LANES];
        for (along, axis) in along.iter_mut().zip([light.x, light.y, light.z]) {
            for lane in 0..LANES {
                let d = [points[0][lane] - anchor.x, points[1][lane] - anchor.y, points[2][lane] - anchor.z];
                along[lane] = d[0] * axis.x + d[1] * axis.y + d[2] * axis.z;
                near[lane] &= along[lane].abs() <= FARTHEST;
            }
        }
        for ((along, min), max) in along.iter().zip(&mut self.min).zip(&mut self.max) {
            for lane in 0..LANES {
                let low = if near[lane] { along[lane] } else { f32::INFINITY };
                let high = if near[lane] { along[lane] } else { f32::NEG_INFINITY };
                min[lane] = if low < min[lane] { low } else { min[lane] };
                max[lane] = if high > max[lane] { high } else { max[lane] };
            }
        }
        for (ignored, near) in self.ignored.iter_mut().zip(near) {
            *ignored += u32::from(!near);
        }
    }

    fn bounds(&self) -> Bounds {
        let least = self.min.map(|lanes| lanes.into_iter().fold(f32::INFINITY, f32::min));
        let most = self.max.map(|lanes| lanes.into_iter().fold(f32::NEG_INFINITY, f32::max));
        Bounds {
            min: Vec3::from(least),
            max: Vec3::from(most),
            ignored: self.ignored.iter().map(|ignored| u64::from(*ignored)).sum(),
        }
    }
}

/// The window of cells, and the way from the world into it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Cells along each edge, *N*.
    pub resolution: u32,
    /// Edge of a cell, *ds*, metres.
    pub cell_size: f32,
    /// The corner of the lattice that is fixed, world space.
    pub anchor: Vec3,
    /// The light's axes divided by the cell's size: scalar products with them count cells.
    pub axes_per_cell: [Vec3; 3],
    /// Lattice coordinates of the window's first cell (the paper's i with index min, and its like for j and k).
    pub first: IVec3,
}

impl Lattice {
    /// The window for hair within `bounds`.
    ///
    /// The cell's size moves in steps of a sixteenth of an octave, so that it stays as it is from frame to
    /// frame while the hair's extent changes little.
    pub fn new(input: &ShadowInput, settings: &VoxelMapSettings, bounds: &Bounds) -> Self {
        let resolution = settings.safe_resolution();
        let (min, max) =
            if bounds.min.x <= bounds.max.x { (bounds.min, bounds.max) } else { (Vec3::ZERO, Vec3::ZERO) };
        let fitting = (max - min).max_element() / (resolution - SPARE_CELLS) as f32;
        let wanted = match settings.extent {
            MapExtent::Fit => fitting,
            MapExtent::Paper => {
                let edge = 2.0 * longest_strand(input.strands) + settings.head_size.clamp(0.0, 10.0);
                fitting.max(edge / resolution as f32)
            }
        };
        // Lattice coordinates stay below 2^16, where f32 still resolves a hundredth of a cell.
        let farthest = min.abs().max(max.abs()).max_element();
        let cell_size = round_up_to_step(wanted.max(SMALLEST_CELL).max(farthest / 65_536.0));
        let per_cell = 1.0 / cell_size;
        let (low, high) = ((min * per_cell).floor().as_ivec3(), (max * per_cell).floor().as_ivec3());
        // What the hair does not need lies half on each side.
        let spare = (IVec3::splat(resolution as i32) - (high - low + 1)).max(IVec3::ZERO);
        let light = &input.light;
        Self {
            resolution,
            cell_size,
            anchor: input.anchor,
            axes_per_cell: [light.x * per_cell, light.y * per_cell, light.z * per_cell],
            first: low - spare / 2,
        }
    }

    /// Coordinates of `p` on the infinite lattice, in cells from the anchor.
    pub fn lattice_from_world(&self, p: Vec3) -> Vec3 {
        let d = p - self.anchor;
        Vec3::from(self.axes_per_cell.map(|axis| d.x * axis.x + d.y * axis.y + d.z * axis.z))
    }

    /// Coordinates of `p` in the window, in cells: its cell is their whole part.
    pub fn window_from_world(&self, p: Vec3) -> Vec3 {
        self.lattice_from_world(p) - self.first.as_vec3()
    }

    /// Whether a point in window coordinates is one of those that the window was made for: finite, and not one
    /// that was left out for its distance.
    pub fn holds(&self, p: Vec3) -> bool {
        p.abs().cmple(Vec3::splat(2.0 * self.resolution as f32)).all()
    }

    /// The paper's mapping Ψ: the cell of `p` in a map that is addressed modulo *N*, so that the window may
    /// slide over the lattice without moving what is stored.
    ///
    /// Read with the floor and the Euclidean modulus: truncation is wrong by a cell below zero.
    pub fn psi(&self, p: Vec3) -> [usize; 3] {
        self.wrapped(self.lattice_from_world(p).floor().as_ivec3())
    }

    /// Where a map addressed modulo *N* stores a cell of the lattice.
    pub fn wrapped(&self, cell: IVec3) -> [usize; 3] {
        cell.to_array().map(|c| c.rem_euclid(self.resolution as i32) as usize)
    }
}

/// Length of the longest strand along its points, metres; strands that are not finite count for nothing.
fn longest_strand(strands: &Strands) -> f32 {
    let ends = strands.first_point.windows(2).map(|ends| ends[0] as usize..ends[1] as usize);
    let length = |range: std::ops::Range<usize>| -> f32 {
        range.clone().zip(range.skip(1)).map(|(a, b)| strands.point(a).distance(strands.point(b))).sum()
    };
    ends.map(length).filter(|length| *length < FARTHEST).fold(0.0, f32::max)
}

/// The next sixteenth of an octave at or above `size`, which must be positive and finite.
fn round_up_to_step(size: f32) -> f32 {
    // 2^(k/16), so that the result is the same wherever this runs.
    const STEPS: [f32; 17] = [
        1.0,
        1.044_273_8,
        1.090_507_7,
        1.138_788_6,
        1.189_207_1,
        1.241_857_8,
        1.296_839_6,
        1.354_255_5,
        std::f32::consts::SQRT_2,
        1.476_826_1,
        1.542_210_8,
        1.610_490_3,
        1.681_792_9,
        1.756_252_2,
        1.834_008_1,
        1.915_206_6,
        2.0,
    ];
    let octave = f32::from_bits(size.to_bits() & 0x7f80_0000);
    let step = STEPS.iter().find(|step| octave * **step >= size);
    octave * step.copied().unwrap_or(2.0)
}
