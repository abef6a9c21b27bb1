//! Strands in PLY files (Greg Turk, *The PLY Polygon File Format*, 1994), as works on the reconstruction of hair write them.
//!
//! The points are the rows of `vertex`. Which strand they belong to is said in one of several ways, of which the first that is there counts:
//! the numbers of segments in an element `strand` (kenshi84's hairutil), lists of vertices, a number of the strand on each vertex, or an
//! element `edge` (Hair-GS, hairutil, Blender). Files without any of them are read if the points lie strand after strand with equal numbers
//! (`NeuralHaircut`, `GaussianHaircut`): between strands, the distance is then many times that within them.

mod header;
mod rows;
mod text;
mod write;

use std::collections::HashMap;

use glam::Vec3;
use lovelock_base::statistics::upper_median_by;
use lovelock_base::words::counted;

use super::HairFileError;
use super::chain::chain;
use super::file::RawHair;
use super::format::HairFormat;
use super::source::Source;
use super::units::UpAxis;
use header::{Element, Form, Header, header};
use rows::Rows;

pub(super) static FORMAT: HairFormat = HairFormat {
    label: "PLY strands",
    extensions: &["ply"],
    signature: "`ply` (PLY)",
    states_unit: false,
    common_up: UpAxis::Y,
    magics: &[b"ply\n", b"ply\r"],
    may_begin: |_| false,
    by_chance: false,
    read,
    write: Some(write::write),
};

/// Elements whose rows are strands.
const STRANDS: [&str; 8] = ["strand", "strands", "curve", "curves", "hair", "polyline", "line", "cell"];
/// Columns of such an element: the number of segments, and the number of points.
const SEGMENTS: [&str; 5] = ["nsegs", "num_segments", "nsegments", "segments", "segment_count"];
const COUNTS: [&str; 8] =
    ["npoints", "num_points", "nverts", "num_vertices", "vertex_count", "point_count", "length", "count"];
/// Lists of vertices.
const LISTS: [&str; 7] =
    ["vertex_indices", "vertex_index", "vertices", "indices", "points", "point_indices", "strand"];
/// Columns of `vertex`: the number of the strand, and of the point within it.
const STRAND_IDS: [&str; 9] = [
    "strand_id",
    "strand_index",
    "strandid",
    "strand_idx",
    "strand",
    "curve_id",
    "curve_index",
    "hair_id",
    "hair_index",
];
const POINT_IDS: [&str; 4] = ["point_id", "point_index", "point_idx", "strand_point"];
/// The comment that the files of this program begin with.
const METRES_Y_UP: &str = "metres, Y up";

/// The largest and the smallest number of points of a strand that is guessed from distances.
const GUESSED: std::ops::RangeInclusive<usize> = 3..=1024;
/// A gap between strands is so many times the median distance between points.
const GAP: f32 = 4.0;
/// The part of the gaps that must lie between strands of equal length, and the part of such places that must be gaps.
const REGULAR: f64 = 0.9;

/// The tables of a file.
#[derive(Default)]
struct Content {
    points: Vec<Vec3>,
    colours: Vec<[f32; 3]>,
    widths: Vec<f32>,
    strand_of: Vec<f64>,
    place_of: Vec<f64>,
    counts: Vec<f64>,
    lists: Vec<Vec<u32>>,
    edges: Vec<[f64; 2]>,
    /// The first number in a list that is no vertex.
    no_index: Option<f64>,
    faces: u64,
}

fn read(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let data = source.into_bytes(name)?;
    let head = header(name, &data)?;
    let mut rows = Rows::new(name, &data, head.end, head.form);
    let mut content = Content::default();
    for element in &head.elements {
        content.read(element, &mut rows)?;
    }
    let says_metres = head.comments.iter().any(|comment| comment == METRES_Y_UP);
    let left = rows.left();
    let mut raw = content.finish(name, &head)?;
    if head.form == Form::Ascii && left > 0 {
        let lines = counted(left, "line", "lines");
        raw.notes.push(format!("Left out {lines} after the rows that the header states."));
    } else {
        raw.trailing_bytes = left;
    }
    Ok(RawHair { says_metres, ..raw })
}

impl Content {
    fn read(&mut self, element: &Element, rows: &mut Rows<'_>) -> Result<(), HairFileError> {
        match element.name.as_str() {
            "vertex" | "vertices" | "point" | "points" => self.read_points(element, rows),
            "edge" | "edges" => {
                let ends = [
                    element.number(&["vertex1", "v1", "start", "begin"]),
                    element.number(&["vertex2", "v2", "end"]),
                ];
                let list = element.list(&LISTS);
                let mut edge = [-1.0; 2];
                let mut known = 0;
                rows.read(element, &mut |_, column, value| {
                    let place = ends.iter().position(|end| *end == Some(column));
                    let place = place.or_else(|| (list == Some(column)).then_some(known));
                    let Some(place) = place.filter(|place| *place < 2) else { return };
                    edge[place] = value;
                    known += 1;
                    if known == 2 {
                        self.edges.push(edge);
                        known = 0;
                    }
                })
            }
            strands if STRANDS.contains(&strands) => {
                let segments = element.number(&SEGMENTS);
                let counts = element.number(&COUNTS);
                let list = element.list(&LISTS);
                let mut last = None;
                rows.read(element, &mut |row, column, value| {
                    if segments == Some(column) {
                        self.counts.push(value + 1.0);
                    } else if segments.is_none() && counts == Some(column) {
                        self.counts.push(value);
                    } else if list == Some(column) {
                        if last != Some(row) {
                            self.lists.push(Vec::new());
                            last = Some(row);
                        }
                        if let Some(strand) = self.lists.last_mut() {
                            let vertex = index(value);
                            if vertex == u32::MAX {
                                self.no_index.get_or_insert(value);
                            }
                            strand.push(vertex);
                        }
                    }
                })
            }
            other => {
                self.faces += if other.starts_with("face") { element.rows } else { 0 };
                rows.read(element, &mut |_, _, _| {})
            }
        }
    }

    fn read_points(&mut self, element: &Element, rows: &mut Rows<'_>) -> Result<(), HairFileError> {
        let axes = ["x", "y", "z"].map(|axis| element.number(&[axis]));
        let colours =
            [["red", "r", "diffuse_red"], ["green", "g", "diffuse_green"], ["blue", "b", "diffuse_blue"]]
                .map(|names| element.number(&names));
        let full = colours[0].map_or(1.0, |column| element.properties[column].ty.full());
        let width = element.number(&["thickness", "width", "diameter"]);
        let radius = element.number(&["radius"]).filter(|_| width.is_none());
        let (strand, place) = (element.number(&STRAND_IDS), element.number(&POINT_IDS));
        let last = element.properties.len() - usize::from(!element.properties.is_empty());
        let (mut point, mut colour) = (Vec3::NAN, [0.0; 3]);
        rows.read(element, &mut |_, column, value| {
            if let Some(axis) = axes.iter().position(|axis| *axis == Some(column)) {
                point[axis] = value as f32;
            } else if let Some(channel) = colours.iter().position(|channel| *channel == Some(column)) {
                colour[channel] = value as f32 / full;
            } else if width == Some(column) {
                self.widths.push(value as f32);
            } else if radius == Some(column) {
                self.widths.push(2.0 * value as f32);
            } else if strand == Some(column) {
                self.strand_of.push(value);
            } else if place == Some(column) {
                self.place_of.push(value);
            }
            if column == last {
                self.points.push(point);
                if colours.iter().all(Option::is_some) {
                    self.colours.push(colour);
                }
            }
        })
    }

    fn finish(self, name: &str, head: &Header) -> Result<RawHair, HairFileError> {
        let malformed = |found: String, wanted: &str| HairFileError::Malformed {
            name: name.to_owned(),
            offset: 0,
            found,
            wanted: wanted.to_owned(),
        };
        let total = self.points.len();
        let mut notes = Vec::new();
        if self.faces > 0 {
            notes.push(format!(
                "{} left out: only strands are hair.",
                counted(self.faces, "face was", "faces were")
            ));
        }
        let in_order = || (0..total as u32).collect::<Vec<_>>();
        let (counts, order): (Vec<u32>, Vec<u32>) = if !self.counts.is_empty() {
            let sum: f64 = self.counts.iter().sum();
            if sum != total as f64 || self.counts.iter().any(|count| *count < 0.0) {
                let vertices = counted(total, "vertex", "vertices");
                let found = format!("{vertices} and strands of {}", counted(sum, "point", "points"));
                return Err(malformed(found, "as many vertices as the strands have points"));
            }
            (self.counts.iter().map(|&count| count as u32).collect(), in_order())
        } else if !self.lists.is_empty() {
            let order: Vec<u32> = self.lists.concat();
            if let Some(&wrong) = order.iter().find(|&&vertex| vertex as usize >= total) {
                let wrong = self.no_index.filter(|_| wrong == u32::MAX).unwrap_or(f64::from(wrong));
                return Err(malformed(
                    format!("vertex {wrong} of a strand"),
                    &format!("0 to {}", total.saturating_sub(1)),
                ));
            }
            (self.lists.iter().map(|strand| strand.len() as u32).collect(), order)
        } else if !self.strand_of.is_empty() {
            grouped(&self.strand_of, &self.place_of)
        } else if !self.edges.is_empty() {
            let edges: Vec<[u32; 2]> = self.edges.iter().map(|edge| edge.map(index)).collect();
            if let Some(at) = edges.as_flattened().iter().position(|&vertex| vertex as usize >= total) {
                let vertex = self.edges.as_flattened()[at];
                return Err(malformed(
                    format!("an edge to vertex {vertex}"),
                    &format!("0 to {}", total.saturating_sub(1)),
                ));
            }
            let chains = chain(&edges, total);
            (chains.counts, chains.vertices)
        } else {
            let Some(count) = regular_count(&self.points).filter(|_| self.faces == 0) else {
                let vertices = counted(total, "vertex", "vertices");
                let found = format!(
                    "{vertices} and {} without strands: no element `strand` or `edge`, and no `strand_id`",
                    counted(self.faces, "face", "faces")
                );
                return Err(malformed(found, "points that belong to strands"));
            };
            notes.push(format!(
                "The file does not say where strands begin; by the distances of its points, each has {count}."
            ));
            (vec![count as u32; total / count], in_order())
        };
        if head.elements.iter().all(|element| element.number(&["x"]).is_none()) {
            return Err(malformed("vertices without `x`, `y` and `z`".to_owned(), "points with coordinates"));
        }
        let picked = |vertex: &u32| *vertex as usize;
        Ok(RawHair {
            thickness: (self.widths.len() == total)
                .then(|| order.iter().map(|v| self.widths[picked(v)]).collect()),
            colours: (self.colours.len() == total)
                .then(|| order.iter().map(|v| self.colours[picked(v)]).collect()),
            notes,
            ..RawHair::new(counts, order.iter().map(|v| self.points[picked(v)]).collect())
        })
    }
}

/// A number as an index; the largest one where it is none.
fn index(value: f64) -> u32 {
    if value >= 0.0 && value < f64::from(u32::MAX) && value.fract() == 0.0 { value as u32 } else { u32::MAX }
}

/// Points of equal numbers as strands, in the order in which the numbers appear first, and by their places if there are any.
fn grouped(strand_of: &[f64], place_of: &[f64]) -> (Vec<u32>, Vec<u32>) {
    let mut number_of: HashMap<u64, u32> = HashMap::new();
    let mut counts: Vec<u32> = Vec::new();
    let mut order: Vec<(u32, u32)> = Vec::with_capacity(strand_of.len());
    for (strand, vertex) in strand_of.iter().zip(0_u32..) {
        let number = *number_of.entry(strand.to_bits()).or_insert(counts.len() as u32);
        if number as usize == counts.len() {
            counts.push(0);
        }
        counts[number as usize] += 1;
        order.push((number, vertex));
    }
    let place = |vertex: u32| place_of.get(vertex as usize).copied().unwrap_or_default();
    order.sort_by(|a, b| {
        a.0.cmp(&b.0).then_with(|| place(a.1).total_cmp(&place(b.1))).then_with(|| a.1.cmp(&b.1))
    });
    (counts, order.into_iter().map(|(_, vertex)| vertex).collect())
}

/// The number of points of each strand, where strands of equal numbers follow each other with gaps between them.
fn regular_count(points: &[Vec3]) -> Option<usize> {
    let steps: Vec<f32> = points.array_windows().map(|[a, b]| a.distance(*b)).collect();
    let mut sorted: Vec<f32> = steps.iter().copied().filter(|step| step.is_finite()).collect();
    let median = upper_median_by(&mut sorted, f32::total_cmp)?;
    let gaps: Vec<usize> =
        (1..).zip(&steps).filter(|(_, step)| **step > GAP * median).map(|(at, _)| at).collect();
    let mut lengths: HashMap<usize, usize> = HashMap::new();
    for [a, b] in gaps.array_windows() {
        *lengths.entry(b - a).or_default() += 1;
    }
    let (&count, _) = lengths.iter().max_by_key(|(length, number)| (**number, **length))?;
    if !GUESSED.contains(&count) || !points.len().is_multiple_of(count) || points.len() / count < 3 {
        return None;
    }
    let between = gaps.iter().filter(|&&gap| gap.is_multiple_of(count)).count() as f64;
    let places = (points.len() / count - 1) as f64;
    (between >= REGULAR * gaps.len() as f64 && between >= REGULAR * places).then_some(count)
}

#[cfg(test)]
mod tests;
