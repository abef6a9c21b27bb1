//! Curves of Alembic archives in the Ogawa form, at the first time of each.
//!
//! The transforms of all ancestors are applied. Cubic curves become polylines. Alembic states neither unit nor up axis;
//! archives of this program do, in their description.

mod frames;
mod marks;
mod objects;
mod shape;
mod transform;
mod values;

use glam::{DMat4, Vec3};
use lovelock_alembic::{AlembicError, Archive, HDF5_MAGIC, OGAWA_MAGIC, Source as Bytes, metadata_value};
use lovelock_base::words::counted;

use super::HairFileError;
use super::basis::Spread;
use super::file::{Hidden, RawHair};
use super::format::HairFormat;
use super::frames::{FramesOrReason, OpenedFrames};
use super::marks::Marks;
use super::partial::Partial;
use super::source::Source;
use super::units::{Unit, UpAxis, display_from_linear};
use objects::{CurveObject, visit};

pub(super) static FORMAT: HairFormat = HairFormat {
    label: "Alembic curves",
    extensions: &["abc"],
    signature: "`Ogawa` (Alembic)",
    states_unit: false,
    common_up: UpAxis::Y,
    // The older form is recognised too, so that the refusal can name it.
    magics: &[OGAWA_MAGIC, HDF5_MAGIC],
    may_begin: |_| false,
    by_chance: false,
    read,
    write: None,
};

/// The description (`_ai_Description`) of an archive whose points are in metres with Y up.
pub const METRES_Y_UP: &str = "metres, Y up";

/// The most points of all polylines.
const MAX_POINTS: usize = 1 << 28;
/// How often the points of a file may be used by objects that share them.
const MAX_SHARING: u64 = 8;

fn read(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let bytes = match source {
        Source::Memory(data) => Bytes::Memory(data),
        Source::File { file, length, .. } => Bytes::File { file, length },
    };
    let mut archive = Archive::open(bytes).map_err(|error| named(name, error))?;
    read_archive(name, &mut archive, &mut |_| {})
}

/// The curves of a file over time, and the hair at the first time.
pub(super) fn frames(name: &str, source: Source<'_>) -> Result<OpenedFrames, HairFileError> {
    let Source::File { file, length, .. } = source else {
        return Err(HairFileError::Io {
            name: name.to_owned(),
            source: std::io::ErrorKind::Unsupported.into(),
        });
    };
    let mut archive = Archive::open(Bytes::File { file, length }).map_err(|error| named(name, error))?;
    let mut objects = Vec::new();
    let raw = read_archive(name, &mut archive, &mut |object| objects.push(object))?;
    let frames: FramesOrReason = match frames::Frames::new(name, archive, objects) {
        Ok(frames) => Ok(Box::new(frames)),
        Err(error) => Err(named(name, error)),
    };
    Ok((frames, raw))
}

fn read_archive(
    name: &str,
    archive: &mut Archive<'_>,
    seen: &mut dyn FnMut(CurveObject),
) -> Result<RawHair, HairFileError> {
    let named = |error| named(name, error);
    let mut hair = Hair::new();
    visit(archive, &mut |archive, object| {
        hair.add(archive, &object)?;
        seen(object);
        Ok(())
    })
    .map_err(named)?;
    if hair.objects == 0 {
        return Err(named(AlembicError::Malformed {
            offset: 0,
            found: "an archive without curves".to_owned(),
            wanted: "one object of curves or more",
        }));
    }
    let mut raw = hair.finish();
    raw.says_metres = metadata_value(archive.metadata(), "_ai_Description") == Some(METRES_Y_UP);
    raw.writer = metadata_value(archive.metadata(), "_ai_Application").and_then(custom_of);
    Ok(raw)
}

/// The unit and the up axis in which a program writes archives, if it is known: Blender turns its Z up to Y up, Houdini works in metres
/// and Maya stores centimetres.
fn custom_of(program: &str) -> Option<(Unit, UpAxis)> {
    let units = [("Blender", Unit::Metre), ("Houdini", Unit::Metre), ("Maya", Unit::Centimetre)];
    units.into_iter().find(|(name, _)| program.starts_with(name)).map(|(_, unit)| (unit, UpAxis::Y))
}

/// The error with the name of its file.
fn named(name: &str, error: AlembicError) -> HairFileError {
    let name = name.to_owned();
    match error {
        AlembicError::Io(source) => HairFileError::Io { name, source },
        AlembicError::Malformed { offset, found, wanted } => {
            HairFileError::Malformed { name, offset, found, wanted: wanted.to_owned() }
        }
    }
}

fn refused(object: &CurveObject, found: impl std::fmt::Display, wanted: &'static str) -> AlembicError {
    AlembicError::Malformed { offset: 0, found: format!("{}: {found}", object.path), wanted }
}

/// The curves so far.
struct Hair {
    raw: RawHair,
    objects: u64,
    /// Control points so far.
    controls: u64,
    /// Width and colour of each point.
    widths: Partial<f32>,
    colours: Partial<[f32; 3]>,
    marks: Marks,
}

impl Hair {
    fn new() -> Self {
        Self {
            raw: RawHair::new(Vec::new(), Vec::new()),
            objects: 0,
            controls: 0,
            widths: Partial::new(f32::NAN),
            colours: Partial::new([f32::NAN; 3]),
            marks: Marks::default(),
        }
    }

    fn add(&mut self, archive: &mut Archive<'_>, object: &CurveObject) -> Result<(), AlembicError> {
        self.objects += 1;
        if object.points.samples == 0 {
            self.raw.notes.push(format!("{}: curves without samples were left out.", object.path));
            return Ok(());
        }
        let secs = archive.times(&object.points).secs(0);
        let counts = object.counts(archive, secs)?;
        let shape = shape::of(archive, object, secs, &mut self.raw.notes)?;
        let controls = archive.elements(&object.points, 0)?;
        let sum = counts.iter().try_fold(0_u64, |sum, &count| sum.checked_add(count as u64));
        if sum != Some(controls) {
            let points = counted(controls, "point", "points");
            let found = format!("{points} in {}", counted(counts.len(), "curve", "curves"));
            return Err(refused(object, found, "as many points as nVertices add up to"));
        }
        self.controls += controls;
        let made = counts
            .iter()
            .fold(self.raw.points.len(), |sum, &count| sum.saturating_add(shape.polyline_points(count)));
        // Objects may share their points; a small file could then ask for any amount of memory.
        if made > MAX_POINTS || 12 * self.controls > MAX_SHARING * archive.length() + (1 << 20) {
            return Err(refused(
                object,
                format!("{made} points"),
                "268435456 at most, and few that are shared",
            ));
        }
        let transform = transform::to_archive(archive, object, secs)?;
        let scale = transform.determinant().abs().cbrt() as f32;
        self.add_points(archive, object, &counts, shape, transform)?;
        let first = self.raw.point_counts.len();
        self.raw.point_counts.extend(counts.iter().map(|&count| shape.polyline_points(count) as u32));

        let widths = &mut self.widths.values;
        let has_widths = match &object.width {
            None => false,
            Some(values) => values::spread(
                archive,
                object,
                values,
                secs,
                &counts,
                shape,
                &mut self.raw.notes,
                &mut |[v]| {
                    widths.push(v * scale);
                },
            )?,
        };
        self.widths.end_at(self.raw.points.len(), has_widths);
        let colours = &mut self.colours.values;
        let has_colours = match &object.colour {
            None => false,
            Some(values) => values::spread(
                archive,
                object,
                values,
                secs,
                &counts,
                shape,
                &mut self.raw.notes,
                &mut |v: [f32; 3]| {
                    colours.push(v.map(display_from_linear));
                },
            )?,
        };
        self.colours.end_at(self.raw.points.len(), has_colours);
        let (is_invisible, changes) = object.is_invisible(archive, secs)?;
        if changes {
            let path = &object.path;
            self.raw
                .notes
                .push(format!("{path}: visibility changes over time; that of the first time is used."));
        }
        marks::add(&mut self.marks, archive, object, &counts, secs)?;
        if is_invisible {
            self.raw.hide_from(first, Some(Hidden::Invisible));
            return Ok(());
        }
        self.add_guides(archive, object, first)
    }

    fn add_points(
        &mut self,
        archive: &mut Archive<'_>,
        object: &CurveObject,
        counts: &[usize],
        shape: super::basis::Shape,
        transform: DMat4,
    ) -> Result<(), AlembicError> {
        let placed = |point: [f32; 3]| transform.transform_point3(Vec3::from(point).as_dvec3()).as_vec3();
        let out = &mut self.raw.points;
        if shape.keeps_points() {
            out.reserve_exact(counts.iter().sum());
            return archive.vectors(&object.points, 0, &mut |point| out.push(placed(point)));
        }
        let mut controls = Vec::with_capacity(counts.iter().sum());
        archive.vectors(&object.points, 0, &mut |point: [f32; 3]| controls.push(placed(point)))?;
        out.extend(shape.spread(Spread::Vertex, &controls, counts));
        Ok(())
    }

    /// Marks the curves from number `first` on that are guides of Unreal's grooms: one value for all, or one for each.
    fn add_guides(
        &mut self,
        archive: &mut Archive<'_>,
        object: &CurveObject,
        first: usize,
    ) -> Result<(), AlembicError> {
        let Some(guides) = object.guides.as_ref().filter(|guides| guides.samples > 0) else { return Ok(()) };
        let curves = self.raw.point_counts.len() - first;
        let count = archive.elements(guides, 0)?;
        if count != 1 && count != curves as u64 {
            return Ok(());
        }
        let mut marks = Vec::new();
        archive.vectors(guides, 0, &mut |[flag]: [f32; 1]| {
            marks.push((flag != 0.0).then_some(Hidden::StandIn));
        })?;
        if let (1, [only]) = (count, marks.as_slice()) {
            self.raw.hide_from(first, *only);
        } else if marks.iter().any(Option::is_some) {
            self.raw.hide_from(first, Some(Hidden::StandIn));
            self.raw.hidden[first..].copy_from_slice(&marks);
        }
        Ok(())
    }

    fn finish(mut self) -> RawHair {
        self.raw.thickness = self.widths.finish(&mut self.raw);
        self.raw.colours = self.colours.finish(&mut self.raw);
        self.raw.marks = self.marks.finish();
        self.raw
    }
}

#[cfg(test)]
mod tests;
