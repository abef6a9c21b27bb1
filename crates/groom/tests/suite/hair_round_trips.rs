//! Every format that is written gives the same hair when it is read, and real files of lines and curves are read.

use crate::common::data_dir;

use std::path::Path;

use glam::Vec3;
use lovelock_groom::{
    Facing, HairFile, HairFormat, ImportSettings, Unit, UpAxis, gltf_content, load_hair, load_hair_bytes,
};

/// How the written files of a format are read: unit, up, face. Those of glTF state the first two.
fn settings(extension: &str) -> ImportSettings {
    let (unit, up, facing) = match extension {
        "hair" => (Unit::Metre, UpAxis::Z, Facing::PlusY),
        "tfx" => (Unit::Centimetre, UpAxis::Y, Facing::PlusZ),
        _ => (Unit::Metre, UpAxis::Y, Facing::PlusZ),
    };
    ImportSettings { unit, up, facing, ..ImportSettings::default() }
}

fn written(hair: &HairFile, extension: &str) -> Result<Vec<u8>, String> {
    let name = format!("a.{extension}");
    let format = HairFormat::of_path(Path::new(&name)).expect("a known format");
    format.write.expect("a format that is written")(hair)
}

fn largest_distance(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// Writes hair and reads it again.
fn there_and_back(hair: &HairFile, extension: &str) -> HairFile {
    let bytes = written(hair, extension).expect(extension);
    let back = load_hair_bytes(&format!("a.{extension}"), &bytes).expect(extension);
    back.in_metres(&settings(extension))
}

#[test]
fn real_files_come_back_from_every_format() {
    let Some(data) = data_dir() else { return };
    for name in [
        "yuksel/straight.hair",
        "tressfx/Ratboy_mohawk_v40.tfx",
        "tressfx/TestHair1.tfx",
        "tressfx/back.tfx",
        "tressfx/sintel_16pt.tfx",
        "tressfx/sintel_vk.tfx",
        "gltf_lines/sintel_LINES.glb",
        "gltf_lines/sintel_LINE_STRIP_x228.glb",
        "pbrt/straight_300.pbrt",
        "pbrt/syntax_mix.pbrt",
        "broken/variable_odd.hair",
        "broken/allflags.hair",
        "broken/nan_inf.hair",
        "broken/zerolen.hair",
    ] {
        let hair =
            load_hair(&data.join("hair").join(name)).expect(name).in_metres(&ImportSettings::default());
        let size = hair.bounds.size().max_element() + hair.bounds.centre().abs().max_element();
        for extension in ["hair", "tfx", "glb", "gltf", "obj", "pbrt"] {
            let lengths: std::collections::BTreeSet<usize> =
                (0..hair.strands()).map(|strand| hair.strand(strand).len()).collect();
            if extension == "tfx" && lengths.len() > 1 {
                assert!(written(&hair, extension).is_err(), "{name}: TressFX has strands of one length");
                continue;
            }
            let back = there_and_back(&hair, extension);
            assert_eq!(back.first_point, hair.first_point, "{name} as {extension}");
            let off = largest_distance(&back.points, &hair.points);
            // Single precision, with a unit and a rotation in between.
            assert!(off <= 1e-6 * size, "{name} as {extension}: {off} m of {size} m");
            if matches!(extension, "hair" | "glb" | "gltf") {
                assert_eq!(
                    back.thickness.is_some(),
                    hair.thickness.is_some()
                        || extension != "hair" && hair.default_thickness.is_some_and(|width| width > 0.0),
                    "{name} as {extension}"
                );
                for (a, b) in back.thickness.iter().flatten().zip(hair.thickness.iter().flatten()) {
                    assert!((a - b).abs() <= 1e-6 * b.abs(), "{name} as {extension}: width {a} for {b}");
                }
            }
            if matches!(extension, "hair" | "glb" | "gltf" | "obj") {
                assert_eq!(back.colours.is_some(), hair.colours.is_some(), "{name} as {extension}");
                let colours = back.colours.iter().flatten().zip(hair.colours.iter().flatten());
                for (a, b) in colours.flat_map(|(a, b)| a.iter().zip(b)) {
                    // glTF stores 16 bits of linear light and no colour above one.
                    assert!(
                        (a - b.clamp(0.0, 1.0)).abs() < 2e-4 || a == b,
                        "{name} as {extension}: {a} for {b}"
                    );
                }
            }
        }
    }
}

#[test]
fn lines_of_gltf_are_the_hair_from_which_they_were_made() {
    let Some(data) = data_dir() else { return };
    let folder = data.join("hair");
    // sintel_vk.tfx is in centimetres.
    let original = load_hair(&folder.join("tressfx/sintel_vk.tfx")).expect("hair");
    for (name, has_widths) in [("sintel_LINES.glb", true), ("sintel_LINE_STRIP_x228.glb", false)] {
        let path = folder.join("gltf_lines").join(name);
        assert!(gltf_content(&path).is_some_and(|content| content.lines), "{name}");
        let lines = load_hair(&path).expect(name);
        assert_eq!((lines.strands(), lines.points.len()), (228, 228 * 32), "{name}");
        assert!(lines.is_in_metres && lines.dropped.is_empty() && lines.notes.is_empty(), "{name}");
        assert_eq!(lines.thickness.is_some(), has_widths, "{name}");
        let scale = lines.bounds.size().y / original.bounds.size().y;
        let scaled: Vec<Vec3> = original.points.iter().map(|&point| scale * point).collect();
        let off = largest_distance(&scaled, &lines.points);
        assert!(off < 1e-4, "{name}: {off} m at a scale of {scale}");
    }
    // The control: characters hold no lines, and are refused as hair.
    for name in ["characters/Fox.glb", "characters/SimpleSkin.gltf", "characters/broken/RecursiveNodes.gltf"]
    {
        assert!(gltf_content(&data.join(name)).is_some_and(|content| !content.lines), "{name}");
        assert!(load_hair(&data.join(name)).is_err(), "{name}");
    }
}

#[test]
fn curves_of_pbrt_are_read() {
    let Some(data) = data_dir() else { return };
    let original = load_hair(&data.join("hair/yuksel/straight.hair")).expect("hair");
    let file = load_hair(&data.join("hair/pbrt/straight_300.pbrt")).expect("hair");
    assert_eq!((file.strands(), file.points.len()), (300, 300 * 41), "five spans of eight pieces");
    assert!(file.dropped.is_empty(), "{:?}", file.dropped);
    let widths = file.thickness.as_ref().expect("widths");
    assert!((widths[0] - 0.1).abs() < 1e-6 && (widths[40] - 0.02).abs() < 1e-6);
    // Roots and tips are control points of straight.hair, rounded to five digits.
    for strand in [0, 1, 299] {
        let points = file.strand(strand);
        let nearest = |point: Vec3, of: usize| {
            let strands = (0..original.strands()).map(|strand| original.strand(strand)[of]);
            strands.map(|other| other.distance(point)).fold(f32::MAX, f32::min)
        };
        assert!(nearest(points[0], 0) < 1e-2 && nearest(points[40], 15) < 1e-2, "{strand}");
    }
    // Three of four curves fit; the missing file is a note. The block moves by one and doubles.
    let mix = load_hair(&data.join("hair/pbrt/syntax_mix.pbrt")).expect("hair");
    assert_eq!((mix.strands(), mix.dropped["unfit_curves"]), (3, 1), "{:?}", mix.notes);
    assert!(mix.notes.iter().any(|note| note.contains("missing-file.pbrt")), "{:?}", mix.notes);
    assert!(mix.strand(0)[1].distance(Vec3::new(0.0, 6.0, 1.0)) < 1e-6);
    assert!((mix.thickness.expect("widths")[0] - 1.0).abs() < 1e-6, "0.5 units, doubled");
}
