//! Where the map's cells lie in the world.
//!
//! The cells are a window of `N × N × N` on an infinite lattice of cubes along the light's axes, one corner of
//! which is the anchor. The window follows the hair; the lattice follows the anchor alone.

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
    pub const EMPTY: Self = Self {
        min: Vec3::splat(f32::INFINITY),
        max: Vec3::splat(f32::NEG_INFINITY),
        ignored: 0,
    };

    /// Bounds of points `first..` of `strands`, `count` of them.
    pub fn of(strands: &Strands, first: usize, count: usize, light: &LightFrame, anchor: Vec3) -> Self {
        let axes = [light.x, light.y, light.z];
        let (mut min, mut max, mut ignored) = ([[f32::INFINITY; 8]; 3], [[f32::NEG_INFINITY; 8]; 3], 0_u32);
        let range = first..first + count;
        let (xs, x_rest) = strands.x[range.clone()].as_chunks::<8>();
        let (ys, y_rest) = strands.y[range.clone()].as_chunks::<8>();
        let (zs, z_rest) = strands.z[range].as_chunks::<8>();
        let mut add = |x: &[f32; 8], y: &[f32; 8], z: &[f32; 8]| {
            for lane in 0..8 {
                let (dx, dy, dz) = (x[lane] - anchor.x, y[lane] - anchor.y, z[lane] - anchor.z);
                let along = axes.map(|axis| dx * axis.x + dy * axis.y + dz * axis.z);
                let near = is_near(along[0]) & is_near(along[1]) & is_near(along[2]);
                ignored += u32::from(!near);
                for axis in 0..3 {
                    let (low, high) = (&mut min[axis][lane], &mut max[axis][lane]);
                    *low = if near & (along[axis] < *low) {
                        along[axis]
                    } else {
                        *low
                    };
                    *high = if near & (along[axis] > *high) {
                        along[axis]
                    } else {
                        *high
                    };
                }
            }
        };
        for ((x, y), z) in xs.iter().zip(ys).zip(zs) {
            add(x, y, z);
        }
        let mut bounds = Self::EMPTY;
        for ((&x, &y), &z) in x_rest.iter().zip(y_rest).zip(z_rest) {
            let p = Vec3::new(x, y, z) - anchor;
            let p = Vec3::from(axes.map(|axis| p.x * axis.x + p.y * axis.y + p.z * axis.z));
            if is_near(p.x) && is_near(p.y) && is_near(p.z) {
                bounds.min = bounds.min.min(p);
                bounds.max = bounds.max.max(p);
            } else {
                bounds.ignored += 1;
            }
        }
        for lane in 0..8 {
            bounds.min = bounds
                .min
                .min(Vec3::from([min[0][lane], min[1][lane], min[2][lane]]));
            bounds.max = bounds
                .max
                .max(Vec3::from([max[0][lane], max[1][lane], max[2][lane]]));
        }
        bounds.ignored += u64::from(ignored);
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

fn is_near(coordinate: f32) -> bool {
    coordinate.abs() <= FARTHEST
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
    /// Lattice coordinates of the window's first cell (the paper's *i_min*, and its like for j and k).
    pub first: IVec3,
}

impl Lattice {
    /// The window for hair within `bounds`.
    ///
    /// The cell's size moves in steps of a sixteenth of an octave, so that it stays as it is from frame to
    /// frame while the hair's extent changes little.
    pub fn new(input: &ShadowInput, settings: &VoxelMapSettings, bounds: &Bounds) -> Self {
        let resolution = settings.safe_resolution();
        let (min, max) = if bounds.min.x <= bounds.max.x {
            (bounds.min, bounds.max)
        } else {
            (Vec3::ZERO, Vec3::ZERO)
        };
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
        let (low, high) = (
            (min * per_cell).floor().as_ivec3(),
            (max * per_cell).floor().as_ivec3(),
        );
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
        Vec3::from(
            self.axes_per_cell
                .map(|axis| d.x * axis.x + d.y * axis.y + d.z * axis.z),
        )
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
        cell.to_array()
            .map(|c| c.rem_euclid(self.resolution as i32) as usize)
    }
}

/// Length of the longest strand along its points, metres; strands that are not finite count for nothing.
fn longest_strand(strands: &Strands) -> f32 {
    let ends = strands
        .first_point
        .windows(2)
        .map(|ends| ends[0] as usize..ends[1] as usize);
    let length = |range: std::ops::Range<usize>| -> f32 {
        range
            .clone()
            .zip(range.skip(1))
            .map(|(a, b)| strands.point(a).distance(strands.point(b)))
            .sum()
    };
    ends.map(length)
        .filter(|length| *length < FARTHEST)
        .fold(0.0, f32::max)
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
        1.414_213_5,
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
