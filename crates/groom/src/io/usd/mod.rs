//! `BasisCurves` of a USD stage, from text (`.usda`), binary crates (`.usdc`) and packages (`.usdz`): one file, its first time sample.
//!
//! A stage states its unit and its up axis, so its points are read in metres with Y up, in the space of the stage: the
//! transforms of all ancestors of a prim are applied. Cubic curves become polylines. References, payloads, sublayers
//! and variants are ignored, and a note says so.

mod frames;
mod marks;
mod package;
mod stage;
mod surface;

use glam::Vec3;
use lovelock_base::words::counted;
use lovelock_usd::{CRATE_MAGIC, TEXT_MAGIC, Value};

use super::HairFileError;
use super::basis::{Basis, Shape, Spread, Wrap};
use super::file::RawHair;
use super::format::HairFormat;
use super::frames::OpenedFrames;
use super::marks::Marks;
use super::partial::Partial;
use super::source::Source;
use super::units::{UpAxis, display_from_linear};
use stage::Stage;

pub(super) static FORMAT: HairFormat = HairFormat {
    label: "USD BasisCurves",
    extensions: &["usdc", "usda", "usd", "usdz"],
    signature: "`#usda` or `PXR-USDC` (USD)",
    states_unit: true,
    common_up: UpAxis::Y,
    magics: &[CRATE_MAGIC, TEXT_MAGIC],
    may_begin: package::is_package,
    by_chance: false,
    read,
    write: None,
};

/// The most points of all polylines.
const MAX_POINTS: usize = 1 << 28;

fn read(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    if package::is_package(source.start()) {
        let data = source.into_bytes(name)?;
        return read_stage(Stage::open(name, Source::Memory(package::stage(name, &data)?))?);
    }
    read_stage(Stage::open(name, source)?)
}

fn read_stage(mut layer: Stage<'_>) -> Result<RawHair, HairFileError> {
    let mut raw = read_layer(&mut layer)?;
    let space = layer.space()?;
    surface::attach(&mut layer, space.metres_from_stage, &mut raw)?;
    Ok(raw)
}

/// The curves of a stage over time, and the hair at the first time.
pub(super) fn frames(name: &str, source: Source<'static>) -> Result<OpenedFrames, HairFileError> {
    frames::open(Stage::open(name, source)?)
}

fn read_layer(layer: &mut Stage<'_>) -> Result<RawHair, HairFileError> {
    let mut raw = RawHair::new(Vec::new(), Vec::new());
    let space = layer.space()?;
    if !space.is_stated {
        raw.notes
            .push("The file states no metersPerUnit; centimetres, the default of USD, are used.".to_owned());
    }
    let prims = layer.curves()?;
    if prims.is_empty() {
        let found = layer.left_out_arcs().map_or_else(String::new, |arcs| format!(" ({arcs})"));
        return Err(layer.malformed(format!("no curves{found}"), "one prim of type BasisCurves or more"));
    }
    raw.notes.extend(layer.left_out_arcs().map(|arcs| sentence(&arcs)));
    match layer.undefined_curves()? {
        0 => {}
        some => raw.notes.push(format!(
            "{} not on the stage: inactive, a class, or an `over` of nothing.",
            counted(some, "prim of curves is", "prims of curves are")
        )),
    }
    let mut widths = Partial::new(f32::NAN);
    let mut colours = Partial::new([f32::NAN; 3]);
    let mut marks = Marks::default();
    for prim in prims {
        let transform = space.metres_from_stage * layer.transform(prim)?;
        let curves = Curves::read(layer, prim, &mut raw.notes)?;
        marks::add(&mut marks, layer, prim, &curves.controls)?;
        let scale = transform.determinant().abs().cbrt() as f32;
        let first = raw.point_counts.len();
        raw.point_counts.extend(&curves.counts);
        let (why, changes) = layer.hidden(prim)?;
        raw.hide_from(first, why);
        if changes {
            let path = layer.path(prim);
            raw.notes.push(format!("{path}: visibility changes over time; that of the first time is used."));
        }
        raw.points.extend(curves.points.iter().map(|p| transform.transform_point3(p.as_dvec3()).as_vec3()));
        let (has_widths, has_colours) = (curves.widths.is_some(), curves.colours.is_some());
        widths.values.extend(curves.widths.iter().flatten().map(|width| width.x * scale));
        widths.end_at(raw.points.len(), has_widths);
        let linear = curves.colours.iter().flatten();
        colours.values.extend(linear.map(|colour| colour.to_array().map(display_from_linear)));
        colours.end_at(raw.points.len(), has_colours);
        if raw.points.len() > MAX_POINTS {
            return Err(layer.malformed(format!("{} points", raw.points.len()), "268435456 at most"));
        }
    }
    raw.marks = marks.finish();
    raw.thickness = widths.finish(&mut raw);
    raw.colours = colours.finish(&mut raw);
    Ok(raw)
}

/// A remark as a sentence.
fn sentence(remark: &str) -> String {
    let first = remark.chars().next().map_or(0, char::len_utf8);
    format!("{}{}.", remark[..first].to_uppercase(), &remark[first..])
}

/// The polylines of one prim, in its own space.
struct Curves {
    counts: Vec<u32>,
    /// Numbers of control points.
    controls: Vec<usize>,
    points: Vec<Vec3>,
    /// Width of each point, repeated in each component.
    widths: Option<Vec<Vec3>>,
    colours: Option<Vec<Vec3>>,
}

impl Curves {
    fn read(layer: &mut Stage<'_>, prim: usize, notes: &mut Vec<String>) -> Result<Self, HairFileError> {
        let path = layer.path(prim);
        let points = layer.attribute(prim, "points", usize::MAX)?.map_or_else(Vec::new, Value::into_vectors);
        let counts = layer.attribute(prim, "curveVertexCounts", points.len())?;
        let counts = counts.map_or_else(Vec::new, Value::into_ints);
        let shape = shape(layer, prim)?;
        let sum =
            counts.iter().try_fold(0_usize, |sum, &count| sum.checked_add(usize::try_from(count).ok()?));
        if sum != Some(points.len()) {
            let points = counted(points.len(), "point", "points");
            let found = format!("{path}: {points} in {}", counted(counts.len(), "curve", "curves"));
            return Err(layer.malformed(found, "as many points as curveVertexCounts add up to"));
        }
        let counts: Vec<usize> = counts.iter().map(|&count| count as usize).collect();
        let made: usize = counts.iter().map(|&count| shape.polyline_points(count)).sum();
        if made > MAX_POINTS {
            return Err(layer.malformed(format!("{path}: curves of {made} points"), "268435456 at most"));
        }
        let mut primvar = |name: &str| -> Result<Option<Vec<Vec3>>, HairFileError> {
            let Some(found) = layer.primvar(prim, name, points.len().max(1))? else { return Ok(None) };
            let name = found.name;
            let mut values = found.values.into_vectors();
            if let Some(indices) = found.indices {
                let picked = indices.iter().map(|&i| usize::try_from(i).ok().and_then(|i| values.get(i)));
                let picked: Option<Vec<Vec3>> = picked.map(Option::<&Vec3>::copied).collect();
                let Some(picked) = picked else {
                    let found = format!("{path}: an index of {name} that is out of range");
                    return Err(layer.malformed(found, "indices of its values"));
                };
                values = picked;
            }
            let spread = Spread::of(found.interpolation.as_deref(), values.len(), &counts, shape);
            let Some(spread) = spread else {
                notes.push(format!(
                    "{path}: {} values of {name} fit no interpolation and were left out.",
                    values.len()
                ));
                return Ok(None);
            };
            Ok(Some(shape.spread(spread, &values, &counts)))
        };
        let widths = primvar("widths")?;
        let colours = primvar("displayColor")?;
        Ok(Self {
            counts: counts.iter().map(|&count| shape.polyline_points(count) as u32).collect(),
            points: shape.spread(Spread::Vertex, &points, &counts),
            widths,
            colours,
            controls: counts,
        })
    }
}

/// Basis and wrap of a prim's curves.
fn shape(layer: &mut Stage<'_>, prim: usize) -> Result<Shape, HairFileError> {
    let mut word = |name: &str, fallback: &str| {
        let value = layer.attribute(prim, name, 1)?;
        Ok(value.as_ref().and_then(Value::token).unwrap_or(fallback).to_owned())
    };
    let (kind, basis, wrap) =
        (word("type", "cubic")?, word("basis", "bezier")?, word("wrap", "nonperiodic")?);
    let basis = match (kind.as_str(), basis.as_str()) {
        ("linear", _) => Basis::Linear,
        ("cubic", "bezier") => Basis::Bezier,
        ("cubic", "bspline") => Basis::Bspline,
        ("cubic", "catmullRom") => Basis::CatmullRom,
        _ => {
            let found = format!("{}: {kind} curves of basis {basis}", layer.path(prim));
            return Err(layer.malformed(found, "linear, or cubic of bezier, bspline or catmullRom"));
        }
    };
    let wrap = match wrap.as_str() {
        "nonperiodic" => Wrap::Nonperiodic,
        "periodic" => Wrap::Periodic,
        "pinned" => Wrap::Pinned,
        _ => {
            let found = format!("{}: wrap {wrap}", layer.path(prim));
            return Err(layer.malformed(found, "nonperiodic, periodic or pinned"));
        }
    };
    Ok(Shape::new(basis, wrap))
}

#[cfg(test)]
mod hidden_tests;
#[cfg(test)]
mod tests;
