//! The strands of a hair file: as they were read, and without what cannot be drawn.

use std::collections::BTreeMap;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::units::UpAxis;

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Its smallest corner.
    pub min: Vec3,
    /// Its largest corner.
    pub max: Vec3,
}

impl Bounds {
    /// The box of no points.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Grows to hold `point`.
    pub fn include(&mut self, point: Vec3) {
        self.min = self.min.min(point);
        self.max = self.max.max(point);
    }

    /// Lengths of the sides; zero for the empty box.
    pub fn size(&self) -> Vec3 {
        (self.max - self.min).max(Vec3::ZERO)
    }

    /// The middle.
    pub fn centre(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }
}

/// What a reader found, before anything is dropped. Arrays over points agree in length with the sum of
/// `point_counts`, which fits `u32`.
pub(super) struct RawHair {
    /// Version of the format, where the file states one.
    pub(super) version: Option<f32>,
    pub(super) point_counts: Vec<u32>,
    pub(super) points: Vec<Vec3>,
    pub(super) thickness: Option<Vec<f32>>,
    pub(super) transparency: Option<Vec<f32>>,
    pub(super) colours: Option<Vec<[f32; 3]>>,
    pub(super) default_thickness: Option<f32>,
    pub(super) default_transparency: Option<f32>,
    pub(super) default_colour: Option<[f32; 3]>,
    pub(super) both_ends_pinned: bool,
    pub(super) trailing_bytes: u64,
    pub(super) notes: Vec<String>,
}

impl RawHair {
    /// Strands and nothing else.
    pub(super) fn new(point_counts: Vec<u32>, points: Vec<Vec3>) -> Self {
        Self {
            version: None,
            point_counts,
            points,
            thickness: None,
            transparency: None,
            colours: None,
            default_thickness: None,
            default_transparency: None,
            default_colour: None,
            both_ends_pinned: false,
            trailing_bytes: 0,
            notes: Vec::new(),
        }
    }
}

/// The strands of a hair file, in the file's unit and axes, cleaned of what cannot be drawn.
///
/// Every strand has at least two points, no two consecutive points coincide, and every number is finite.
#[derive(Clone, Debug, PartialEq)]
pub struct HairFile {
    /// What the file is called, for messages.
    pub name: String,
    /// The format that it was read from, with its version where it has one: `TressFX .tfx 4.0`.
    pub format: String,
    /// The axis that points up in most files of this format.
    pub common_up: UpAxis,
    /// Whether the points are in metres with Y up already: the format states its unit and axes, or the file was converted.
    pub is_in_metres: bool,
    /// Index of the first point of each strand, with the number of points at the end (strands + 1).
    pub first_point: Vec<u32>,
    /// Points of all strands, root first, file units and axes.
    pub points: Vec<Vec3>,
    /// Width of the hair at each point, file units, where the file says so for each point.
    pub thickness: Option<Vec<f32>>,
    /// Transparency of each point, 0 opaque to 1, where the file says so for each point.
    pub transparency: Option<Vec<f32>>,
    /// Colour of each point, as the file has it (display values, usually in 0..=1).
    pub colours: Option<Vec<[f32; 3]>>,
    /// Width of all hair, file units, where the file says so.
    pub default_thickness: Option<f32>,
    /// Transparency of all hair, where the file says so.
    pub default_transparency: Option<f32>,
    /// Colour of all hair, where the file says so.
    pub default_colour: Option<[f32; 3]>,
    /// The file marks both ends of its strands as held (TressFX); only roots are held here.
    pub both_ends_pinned: bool,
    /// How many of what were left out: strands, points, bytes. Empty where nothing was.
    pub dropped: BTreeMap<String, u64>,
    /// Remarks in sentences, for people.
    pub notes: Vec<String>,
    /// Smallest box of the points, file units and axes.
    pub bounds: Bounds,
}

impl HairFile {
    /// Number of strands.
    pub fn strands(&self) -> usize {
        self.first_point.len() - 1
    }

    /// Number of segments of all strands.
    pub fn segments(&self) -> usize {
        self.points.len() - self.strands()
    }

    /// The points of strand `strand`, root first, file units and axes.
    pub fn strand(&self, strand: usize) -> &[Vec3] {
        &self.points[self.first_point[strand] as usize..self.first_point[strand + 1] as usize]
    }

    /// The roots of all strands, file units and axes.
    pub fn roots(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.first_point[..self.strands()].iter().map(|&first| self.points[first as usize])
    }
}
