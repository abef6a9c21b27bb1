//! `lovelock convert`: converts between hair formats.

use std::path::Path;

use glam::Vec3;
use lovelock_base::watch::Watch;
use lovelock_groom::{
    HAIR_FORMATS, HairFile, HairFormat, ImportSettings, SURE, Unit, UpAxis, guess_units, load_hair_watched,
};
use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;
use lovelock_record::{CurveFormat, CurveFrame, CurveScene, CurveWriter, FrameRate, RecordError};
use serde::Serialize;

/// Width of hair if the file contains none, metres.
const WIDTH_M: f32 = 1e-4;

/// The result, as `convert --json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConvertReport {
    /// The new file.
    pub out: String,
    /// Number of strands.
    pub strands: u64,
    /// Number of points.
    pub points: u64,
    /// Size in bytes.
    pub bytes: u64,
    /// Notes about the input file, as sentences.
    pub notes: Vec<String>,
}

/// Writes the hair of a file in another format, by the extension of `out`: one of [`written_extensions`].
///
/// # Errors
/// A file that cannot be read, a name of no such format, hair that the format cannot hold, and a full disk.
pub fn convert(
    input: &Path,
    out: &Path,
    unit: Unit,
    up: UpAxis,
    include_hidden: bool,
) -> Result<ConvertReport, ProjectError> {
    let format = HairFormat::of_path(out).filter(|_| has_extension(out, &written_extensions()));
    let write = format.and_then(|format| format.write);
    if write.is_none() && CurveFormat::of(out).is_none() {
        return Err(ProjectError::option(format!(
            "{}: found no extension of a hair format; must end in .{}",
            out.display(),
            written_extensions().join(", .")
        )));
    }
    let read = load_hair_watched(input, include_hidden, &Watch::default())
        .map_err(|error| ProjectError::input(input, error))?;
    let settings = ImportSettings { unit, up, ..ImportSettings::default() };
    let hair = read.in_metres(&settings);
    let mut notes = hair.notes.clone();
    notes.extend(read.note_on_up(&settings));
    let guess = guess_units(&read);
    if unit == Unit::Auto && guess.unit_confidence < SURE {
        notes.push(format!("{} `--unit` sets another unit.", guess.reason));
    }
    let bytes = if let Some(write) = write {
        notes.extend(marks_left_out(&hair, out));
        let bytes =
            write(&hair).map_err(|why| ProjectError::input(input, format!("{}: {why}", input.display())))?;
        write_whole(out, &bytes)?;
        bytes.len() as u64
    } else {
        write_curves(&hair, out).map_err(|error| {
            let (file, message) = (Some(out.to_owned()), error.to_string());
            if error.is_request() {
                ProjectError::Request { file, message }
            } else {
                ProjectError::Work { file, message }
            }
        })?
    };
    Ok(ConvertReport {
        out: out.display().to_string(),
        strands: hair.strands() as u64,
        points: hair.points.len() as u64,
        bytes,
        notes,
    })
}

/// What `out`, which is neither USD nor Alembic, has no place for, as a sentence.
fn marks_left_out(hair: &HairFile, out: &Path) -> Option<String> {
    let mut parts = Vec::new();
    if !hair.marks.groups.is_empty() {
        parts.push("the groups of strands");
    }
    if !hair.marks.root_uvs.is_empty() {
        parts.push("the coordinates of roots");
    }
    let extension = out.extension().unwrap_or_default().to_string_lossy();
    let what = parts.join(" and ");
    (!parts.is_empty())
        .then(|| format!("Left out {what}: .{extension} has no place for them; USD and Alembic have."))
}

/// Extensions of the hair files that can be written, without the dot.
pub fn written_extensions() -> Vec<&'static str> {
    let written = HAIR_FORMATS.into_iter().filter(|format| format.write.is_some());
    // Compressed files are only read.
    let own: Vec<&str> = written
        .flat_map(|format| format.extensions)
        .copied()
        .filter(|&extension| extension != "gz")
        .collect();
    let others = CurveFormat::EXTENSIONS.into_iter().filter(|extension| !own.contains(extension));
    own.iter().copied().chain(others).collect()
}

fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
    extension.is_some_and(|extension| extensions.contains(&extension.as_str()))
}

fn write_curves(hair: &HairFile, out: &Path) -> Result<u64, RecordError> {
    let points = hair.points.len();
    let linear = |colour: &[f32; 3]| Vec3::from(colour.map(linear_of));
    let usual = hair.default_colour.unwrap_or([0.35, 0.25, 0.18]);
    let scene = CurveScene {
        rate: FrameRate { num: 24, den: 1 },
        first_frame: 0,
        frames: 1,
        first_point: hair.first_point.clone(),
        widths: hair
            .thickness
            .clone()
            .unwrap_or_else(|| vec![hair.default_thickness.filter(|w| *w > 0.0).unwrap_or(WIDTH_M); points]),
        colors: hair
            .colours
            .as_ref()
            .map_or_else(|| vec![linear(&usual); points], |colours| colours.iter().map(linear).collect()),
        are_guides: false,
        marks: hair.marks.clone(),
        body: None,
    };
    let axis = |k: usize| hair.points.iter().map(|point| point[k]).collect::<Vec<_>>();
    let [x, y, z] = [0, 1, 2].map(axis);
    let mut writer = CurveWriter::create(out, scene)?;
    writer.push(&CurveFrame { points: [&x, &y, &z], body: None })?;
    Ok(writer.finish()?.bytes)
}

/// From a display value to linear sRGB.
fn linear_of(v: f32) -> f32 {
    let v = v.clamp(0.0, 1.0);
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::load_hair;

    use super::*;

    #[test]
    fn groups_and_roots_survive_usd_and_alembic() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        let text = "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\ndef BasisCurves \"a\"\n{\n\
            uniform token type = \"linear\"\nint[] curveVertexCounts = [2, 2, 1, 2]\n\
            point3f[] points = [(0.1, 0.2, 0), (0, 0.5, 0.3), (0, 0.1, 0), (0.3, 0, 0.2), (0, 0, 0), (0, 0, 0.1), (0, 0, 0.2)]\n\
            int[] primvars:groom_group_id = [3, 1, 2, 3] (\n interpolation = \"uniform\"\n)\n\
            string[] primvars:groom_group_name = [\"scalp\", \"fringe\"] (\n interpolation = \"uniform\"\n)\n\
            int[] primvars:groom_group_name:indices = [0, 1, 0, 0]\n\
            texCoord2f[] primvars:surface_uv_coordinate = [(0.1, 0.2), (0.3, 0.4), (0, 0), (0.5, 0.75)] (\n interpolation = \"uniform\"\n)\n}\n";
        std::fs::write(at("a.usda"), text).expect("a file");
        let first = load_hair(&at("a.usda")).expect("hair");
        assert_eq!(first.marks.groups, [3, 1, 3], "the strand of one point is left out");
        assert_eq!(first.marks.root_uvs, [[0.1, 0.2], [0.3, 0.4], [0.5, 0.75]]);
        assert!(
            first
                .notes
                .iter()
                .any(|note| note.contains("2 groups of strands: 1 (fringe) has 1 strand, 3 (scalp) has 2")),
            "{:?}",
            first.notes
        );
        let mut from = at("a.usda");
        for name in ["b.abc", "c.usdc", "d.abc", "e.usda", "f.usd"] {
            let report = convert(&from, &at(name), Unit::Auto, UpAxis::Auto, false).expect(name);
            let lost = report.notes.iter().find(|note| note.contains("Left out the groups"));
            assert!(lost.is_none(), "{name}: {lost:?}");
            from = at(name);
            assert_eq!(load_hair(&from).expect(name).marks, first.marks, "{name}");
        }
        // Negative control: formats without groups, which a note says.
        for name in ["g.obj", "h.glb", "i.ply", "j.npz", "k.hair"] {
            let notes = convert(&from, &at(name), Unit::Auto, UpAxis::Auto, false).expect(name).notes;
            let expected = "Left out the groups of strands and the coordinates of roots: .";
            assert!(notes.iter().any(|note| note.starts_with(expected)), "{name}: {notes:?}");
            assert!(load_hair(&at(name)).expect(name).marks.groups.is_empty());
        }
    }

    #[test]
    fn hair_goes_through_every_format_and_comes_back() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        let text = "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\ndef BasisCurves \"a\"\n{\n\
            uniform token type = \"linear\"\nint[] curveVertexCounts = [2, 2]\n\
            point3f[] points = [(0.1, 0.2, 0), (0, 0.5, 0.3), (0, 0.1, 0), (0.3, 0, 0.2)]\n\
            color3f[] primvars:displayColor = [(0.2, 0.1, 0.05)]\n}\n";
        std::fs::write(at("a.usda"), text).expect("a file");
        let first = load_hair(&at("a.usda")).expect("hair").in_metres(&ImportSettings::default());
        let mut from = at("a.usda");
        for (name, unit, up) in [
            ("b.hair", Unit::Auto, UpAxis::Auto),
            ("c.usdc", Unit::Metre, UpAxis::Z),
            ("d.tfx", Unit::Auto, UpAxis::Auto),
            ("e.obj", Unit::Centimetre, UpAxis::Y),
            ("f.glb", Unit::Metre, UpAxis::Y),
            ("g.pbrt", Unit::Auto, UpAxis::Auto),
            ("h.gltf", Unit::Metre, UpAxis::Y),
            ("i.usda", Unit::Auto, UpAxis::Auto),
            ("j.ply", Unit::Auto, UpAxis::Auto),
            ("k.npy", Unit::Auto, UpAxis::Auto),
            ("l.npz", Unit::Metre, UpAxis::Y),
            ("m.ply", Unit::Metre, UpAxis::Y),
        ] {
            let report = convert(&from, &at(name), unit, up, false).expect(name);
            assert_eq!((report.strands, report.points), (2, 4), "{name}");
            from = at(name);
        }
        let last = load_hair(&from).expect("hair");
        // The facing direction is guessed, so only heights and lengths are compared.
        for (a, b) in last.points.iter().zip(&first.points) {
            assert!((a.y - b.y).abs() < 1e-4 && (a.length() - b.length()).abs() < 1e-4, "{a} for {b}");
        }
        for name in ["k.data", "k.stl", "k.gz"] {
            let error = convert(&from, &at(name), Unit::Auto, UpAxis::Auto, false).expect_err("not written");
            assert!(error.to_string().contains(".hair, .tfx, .glb, .gltf, .obj, .pbrt"), "{error}");
            assert_eq!(error.exit_code(), 2, "{error}");
        }
    }
}
