//! The strands of a hair file, as read and after cleaning.

use std::collections::BTreeMap;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::units::{Unit, UpAxis};
use crate::StrandMarks;

/// The most points that a file may have by showing the same ones in several places.
pub(super) const MAX_COPIED_POINTS: usize = 1 << 25;

/// A box aligned with the axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Its smallest corner.
    pub min: Vec3,
    /// Its largest corner.
    pub max: Vec3,
}

impl Bounds {
    /// The empty box.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Extends the box to contain `point`.
    pub fn include(&mut self, point: Vec3) {
        self.min = self.min.min(point);
        self.max = self.max.max(point);
    }

    /// Lengths of the sides; zero for an empty box.
    pub fn size(&self) -> Vec3 {
        (self.max - self.min).max(Vec3::ZERO)
    }

    /// The centre.
    pub fn centre(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }
}

/// Why a strand is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hidden {
    /// It or something above it is invisible.
    Invisible,
    /// It is a guide or a proxy, which stands for other strands.
    StandIn,
    /// It is a prototype, of which copies are drawn in other places.
    Prototype,
}

/// The content of a file before cleaning. The lengths of arrays over points equal the sum of `point_counts`, which fits
/// `u32`.
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
    /// Counts of what the reader left out, by kind.
    pub(super) dropped: BTreeMap<String, u64>,
    pub(super) notes: Vec<String>,
    /// Whether this file says that its points are in metres with Y up, although its format states no unit.
    pub(super) says_metres: bool,
    /// The unit and the up axis of the program that wrote the file, if it is known.
    pub(super) writer: Option<(Unit, UpAxis)>,
    /// Which points of the file are here, if the reader left some out.
    pub(super) left_out: Option<Vec<bool>>,
    pub(super) marks: StrandMarks,
    /// Why each strand is hidden; may be shorter than the strands, of which the others are drawn.
    pub(super) hidden: Vec<Option<Hidden>>,
    /// Whether values that are not finite are those of curves that state none.
    pub(super) lacks_values: bool,
}

impl RawHair {
    /// Strands without other attributes.
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
            dropped: BTreeMap::new(),
            notes: Vec::new(),
            says_metres: false,
            writer: None,
            left_out: None,
            marks: StrandMarks::default(),
            hidden: Vec::new(),
            lacks_values: false,
        }
    }
}

/// The strands of a hair file, in the file's unit and axes, without those that cannot be drawn.
///
/// Every strand has at least two points, no two consecutive points coincide, and every number is finite.
#[derive(Clone, Debug, PartialEq)]
pub struct HairFile {
    /// Name of the file, for messages.
    pub name: String,
    /// The format of the file, with its version if it has one: `TressFX .tfx 4.0`.
    pub format: String,
    /// The axis that points up in most files of this format.
    pub common_up: UpAxis,
    /// The axis that points up in most files of the program that wrote this one, if it is known.
    pub written_up: Option<UpAxis>,
    /// The unit of most files of that program.
    pub written_unit: Option<Unit>,
    /// Whether the points are in metres with Y up, because the file or its format states its unit and axes, or the file
    /// was converted.
    pub is_in_metres: bool,
    /// Index of the first point of each strand, then the number of points (strands + 1 entries).
    pub first_point: Vec<u32>,
    /// Points of all strands, root first, file units and axes.
    pub points: Vec<Vec3>,
    /// Width of the hair at each point, file units, if the file has one per point.
    pub thickness: Option<Vec<f32>>,
    /// Transparency of each point, 0 (opaque) to 1, if the file has one per point.
    pub transparency: Option<Vec<f32>>,
    /// Colour of each point as stored in the file (display values, usually in 0..=1).
    pub colours: Option<Vec<[f32; 3]>>,
    /// Width of all hair, file units, if the file states it.
    pub default_thickness: Option<f32>,
    /// Transparency of all hair, if the file states it.
    pub default_transparency: Option<f32>,
    /// Colour of all hair, if the file states it.
    pub default_colour: Option<[f32; 3]>,
    /// The file marks both ends of its strands as held (TressFX); this program holds only roots.
    pub both_ends_pinned: bool,
    /// Groups of strands, and places of roots on a surface, if the file states them.
    pub marks: StrandMarks,
    /// Counts of dropped strands, points and bytes by kind. Empty if nothing was dropped.
    pub dropped: BTreeMap<String, u64>,
    /// Remarks, as sentences.
    pub notes: Vec<String>,
    /// Bounding box of the points, file units and axes.
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
