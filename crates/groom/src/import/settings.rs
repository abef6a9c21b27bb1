//! What a person may decide about an import.

use std::f32::consts::PI;
use std::ops::RangeInclusive;

use glam::Vec3;
use lovelock_base::statistics::upper_median_by;
use serde::{Deserialize, Serialize};

use crate::{Facing, Unit, UpAxis};

/// How a hair file becomes a hairstyle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ImportSettings {
    /// Unit of the file's coordinates.
    pub unit: Unit,
    /// Axis of the file that points up.
    pub up: UpAxis,
    /// Axis of the file that the face looks along.
    pub facing: Facing,
    /// Scale the groom evenly so that its roots fit the scalp; else it keeps the size that the unit gives it.
    pub fit_scale: bool,
    /// Move each strand as a whole by the gap that is left between its root and the skin.
    pub snap_roots: bool,
    /// Number of wisps to aim for; 0 takes one for every 25 strands, 64 to 512. See [`Self::WISPS`].
    pub wisps: u32,
    /// Points of a guide; 0 takes the median of the file's strands, 8 to 40. See [`Self::POINTS_PER_GUIDE`].
    pub points_per_guide: u32,
    /// Where to put the groom after it was fitted.
    pub placement: Placement,
    /// Chooses among equally good groupings of strands, and their shades.
    pub seed: u32,
}

/// A change of place after the fit, about the middle of the scalp.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Placement {
    /// Even scale. See [`Self::SCALE`].
    pub scale: f32,
    /// Turns about the axes x (nod), then y (shake), then z (tilt), radians. See [`Self::TURN`].
    pub turn: Vec3,
    /// Shift along the axes of the head, metres. See [`Self::OFFSET_M`].
    pub offset_m: Vec3,
}

impl Placement {
    /// Range of `scale`.
    pub const SCALE: RangeInclusive<f32> = 0.25..=4.0;
    /// Range of each component of `turn`, radians.
    pub const TURN: RangeInclusive<f32> = -PI..=PI;
    /// Range of each component of `offset_m`, metres.
    pub const OFFSET_M: RangeInclusive<f32> = -0.5..=0.5;
}

impl Default for Placement {
    fn default() -> Self {
        Self { scale: 1.0, turn: Vec3::ZERO, offset_m: Vec3::ZERO }
    }
}

impl Default for ImportSettings {
    fn default() -> Self {
        Self {
            unit: Unit::Auto,
            up: UpAxis::Auto,
            facing: Facing::Auto,
            fit_scale: true,
            snap_roots: true,
            wisps: 0,
            points_per_guide: 0,
            placement: Placement::default(),
            seed: 0,
        }
    }
}

impl ImportSettings {
    /// Range of `wisps`.
    pub const WISPS: RangeInclusive<u32> = 0..=4096;
    /// Range of `points_per_guide`, besides 0.
    pub const POINTS_PER_GUIDE: RangeInclusive<u32> = 4..=64;

    /// The same with every number brought into its range; what is no number becomes the default.
    pub fn in_range(mut self) -> Self {
        let clamp = |value: f32, range: RangeInclusive<f32>, default: f32| {
            if value.is_nan() { default } else { value.clamp(*range.start(), *range.end()) }
        };
        self.wisps = self.wisps.min(*Self::WISPS.end());
        if self.points_per_guide > 0 {
            let range = Self::POINTS_PER_GUIDE;
            self.points_per_guide = self.points_per_guide.clamp(*range.start(), *range.end());
        }
        let placement = &mut self.placement;
        placement.scale = clamp(placement.scale, Placement::SCALE, 1.0);
        for axis in 0..3 {
            placement.turn[axis] = clamp(placement.turn[axis], Placement::TURN, 0.0);
            placement.offset_m[axis] = clamp(placement.offset_m[axis], Placement::OFFSET_M, 0.0);
        }
        self
    }

    /// How many wisps to make of `strands` strands. Left to itself it keeps three strands a wisp, as many as
    /// a wisp has guides.
    pub(super) fn wisps_for(&self, strands: usize) -> usize {
        match self.wisps as usize {
            0 => (strands / 25).clamp(64, 512).min(strands / 3).max(1),
            wisps => wisps.min(strands),
        }
    }

    pub(super) fn points_per_guide_for(&self, first_point: &[u32]) -> usize {
        if self.points_per_guide > 0 {
            return self.points_per_guide as usize;
        }
        let mut counts: Vec<u32> = first_point.array_windows().map(|[a, b]| b - a).collect();
        upper_median_by(&mut counts, Ord::cmp).unwrap_or_default().clamp(8, 40) as usize
    }
}
