//! The extent of the hair along the axes of a light, and sizes of cells that are stable from frame to frame.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use glam::Vec3;
use lovelock_base::simd_versions;
use lovelock_groom::Strands;
use rayon::prelude::*;

use crate::{LightFrame, ShadowInput};

/// Points farther from the anchor than this on any axis are ignored, metres.
pub(crate) const FARTHEST: f32 = 1e4;

/// The smallest cell, metres, so that hair collapsed to a point does not make cells of size 0.
pub(crate) const SMALLEST_CELL: f32 = 1e-5;

/// Points per parallel task.
const POINTS_PER_PIECE: usize = 1 << 14;

simd_versions! {
    /// [`Bounds::of_points`] for the vectors of `width`.
    pub(crate) fn bounds_simd(x: &[f32], y: &[f32], z: &[f32], light: &LightFrame, anchor: Vec3) -> Bounds {
        Bounds::of_points(x, y, z, light, anchor)
    }
}

/// The extent of the hair along the light's axes, relative to the anchor, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates; above `max` if there is no point.
    pub min: Vec3,
    /// Largest coordinates.
    pub max: Vec3,
    /// Points that were ignored because they are not finite or too far away.
    pub ignored: u64,
}

impl Bounds {
    /// Empty bounds.
    pub const EMPTY: Self =
        Self { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY), ignored: 0 };

    /// Bounds of points. All slices have the same length.
    #[inline(always)]
    pub(crate) fn of_points(x: &[f32], y: &[f32], z: &[f32], light: &LightFrame, anchor: Vec3) -> Self {
        let mut running = Running::default();
        let (xs, x_rest) = x.as_chunks::<LANES>();
        let (ys, y_rest) = y.as_chunks::<LANES>();
        let (zs, z_rest) = z.as_chunks::<LANES>();
        for ((x, y), z) in xs.iter().zip(ys).zip(zs) {
            running.add([x, y, z], light, anchor);
        }
        // The rest, padded with points that are ignored.
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

    /// Bounds of all points of `input`, in parallel.
    pub fn of_strands(input: &ShadowInput) -> Self {
        let Strands { x, y, z, .. } = input.strands;
        let pieces = x
            .par_chunks(POINTS_PER_PIECE)
            .zip(y.par_chunks(POINTS_PER_PIECE))
            .zip(z.par_chunks(POINTS_PER_PIECE));
        pieces
            .map(|((x, y), z)| Self::of_points(x, y, z, &input.light, input.anchor))
            .reduce(|| Self::EMPTY, Self::join)
    }

    /// The union of both.
    pub fn join(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            ignored: self.ignored + other.ignored,
        }
    }
}

/// Points that are processed together. The compiler unrolls loops over 16 lanes before it looks for vectors, and then finds none.
const LANES: usize = 64;

/// Intermediate bounds, one per lane.
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
        // 0 where a point is near. Words as wide as the coordinates: with booleans the loops below become scalar.
        let mut far = [0_u32; LANES];
        for (along, axis) in along.iter_mut().zip([light.x, light.y, light.z]) {
            for lane in 0..LANES {
                let d = [points[0][lane] - anchor.x, points[1][lane] - anchor.y, points[2][lane] - anchor.z];
                along[lane] = d[0] * axis.x + d[1] * axis.y + d[2] * axis.z;
                let is_near = along[lane].abs() <= FARTHEST;
                far[lane] |= u32::from(!is_near);
            }
        }
        for ((along, min), max) in along.iter().zip(&mut self.min).zip(&mut self.max) {
            for lane in 0..LANES {
                let low = if far[lane] == 0 { along[lane] } else { f32::INFINITY };
                let high = if far[lane] == 0 { along[lane] } else { f32::NEG_INFINITY };
                min[lane] = if low < min[lane] { low } else { min[lane] };
                max[lane] = if high > max[lane] { high } else { max[lane] };
            }
        }
        for (ignored, far) in self.ignored.iter_mut().zip(far) {
            // At most one per block of points; a check for overflow would be a branch.
            *ignored = ignored.wrapping_add(far);
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

/// `size`, which must be positive and finite, rounded up to a sixteenth of an octave.
pub(crate) fn round_up_to_step(size: f32) -> f32 {
    // 2^(k/16) as constants, so that the result is the same on every platform.
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
