use std::path::{Path, PathBuf};

use lovelock_alembic::{ArchiveWriter, CompoundTree, DataType, ObjectTree, Pod, Samples, Times};

use super::*;
use crate::{METRES_Y_UP, load_hair};

const POINT: DataType = DataType::new(Pod::F32, 3);
const INT: DataType = DataType::new(Pod::I32, 1);

/// Completes an archive of one object of curves.
fn finish(mut writer: ArchiveWriter<std::fs::File>, metadata: &str, [points, counts]: [Samples; 2]) {
    let mut basis = Samples::scalar(DataType::new(Pod::U8, 4), 0);
    basis.push(writer.store(basis.ty, &[1, 0, 0, 0]).expect("a sample"));
    let (mut schema, mut properties) = (CompoundTree::default(), CompoundTree::default());
    schema.samples("P", "geoScope=vtx", points);
    schema.samples("nVertices", "", counts);
    schema.samples("curveBasisAndType", "", basis);
    properties.compound(".geom", "", schema);
    let metadata_of_object = "schema=AbcGeom_Curve_v2".to_owned();
    let object = ObjectTree {
        name: "hair".to_owned(),
        metadata: metadata_of_object,
        properties,
        children: Vec::new(),
    };
    writer.finish(metadata, vec![object]).expect("an archive");
}

/// An archive of one curve, whose number of points at each time is given.
fn write_abc(path: &Path, counts: &[i32], metadata: &str) {
    let mut writer = ArchiveWriter::create(std::fs::File::create(path).expect("a file")).expect("a file");
    let times = writer.add_times(Times::uniform(0.5, 0.25));
    let (mut points, mut of_curves) = (Samples::array(POINT, times), Samples::array(INT, times));
    for (frame, &count) in counts.iter().enumerate() {
        let at = |i: i32| [0.1 * i as f32, 0.2 * i as f32, frame as f32];
        let bytes: Vec<u8> = (0..count).flat_map(at).flat_map(f32::to_le_bytes).collect();
        points.push(writer.store(POINT, &bytes).expect("a sample"));
        of_curves.push(writer.store(INT, &count.to_le_bytes()).expect("a sample"));
    }
    finish(writer, metadata, [points, of_curves]);
}

/// A stage of two prims. The points of the first have samples at 0 and 10, those of the second at 0, 5 and 10.
fn write_usd(path: &Path, counts: &str) {
    let text = format!(
        "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n timeCodesPerSecond = 10\n)\n\
        def BasisCurves \"a\"\n{{\n uniform token type = \"linear\"\n int[] curveVertexCounts{counts}\n\
        point3f[] points.timeSamples = {{ 0: [(0, 0, 0), (0, 1, 0)], 10: [(4, 0, 0), (0, 3, 0)] }}\n}}\n\
        def BasisCurves \"b\"\n{{\n uniform token type = \"linear\"\n int[] curveVertexCounts = [2]\n\
        point3f[] points.timeSamples = {{ 0: [(1, 0, 0), (1, 1, 0)], 5: [(2, 0, 0), (2, 1, 0)], 10: [(1, 0, 0), (1, 1, 0)] }}\n}}\n"
    );
    std::fs::write(path, text).expect("a file");
}

fn folder() -> (tempfile::TempDir, impl Fn(&str) -> PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path().to_owned();
    (folder, move |name: &str| root.join(name))
}

#[test]
fn curves_that_cannot_be_played_say_why_and_are_a_still_hairstyle() {
    let (_folder, at) = folder();
    for (name, refused) in
        [("grows.abc", true), ("moves.abc", false), ("grows ü.usda", true), ("moves.usda", false)]
    {
        let path = at(name);
        if path.extension().is_some_and(|ending| ending == "abc") {
            write_abc(&path, if refused { &[3, 4, 5] } else { &[3, 3, 3] }, "");
        } else {
            // Equal counts at several times do not change.
            write_usd(
                &path,
                if refused {
                    ".timeSamples = { 0: [2], 10: [3] }"
                } else {
                    ".timeSamples = { 0: [2], 10: [2] }"
                },
            );
        }
        let motion = CurveMotion::of(&path);
        let still = load_hair(&path).expect("a still hairstyle");
        assert!(still.strands() >= 1);
        if refused {
            let said = motion.problem().expect("a reason");
            assert!(said.contains(name) && said.contains("number of points changes"), "{said}");
            assert!(said.contains("cannot be played") && said.contains("still hairstyle"), "{said}");
            assert_eq!(said.lines().count(), 1, "{said}");
            let error =
                CurveCache::open(&path, Unit::Auto, UpAxis::Auto, false).expect_err("refused").to_string();
            assert!(said.starts_with(&error), "{error}");
        } else {
            assert!(
                matches!(motion, CurveMotion::Moving(3)) && motion.problem().is_none(),
                "{name}: {motion:?}"
            );
        }
    }
    // One time, another format and a broken file are still; the last is reported by whoever reads it.
    write_abc(&at("one.abc"), &[3], "");
    std::fs::write(at("a.hair"), b"HAIR and more").expect("a file");
    std::fs::write(at("cut.usda"), b"#usda 1.0\ndef BasisCurves").expect("a file");
    for name in ["one.abc", "a.hair", "cut.usda", "gone.abc"] {
        assert!(matches!(CurveMotion::of(&at(name)), CurveMotion::Still), "{name}");
    }
    assert!(load_hair(&at("cut.usda")).is_err());
}

#[test]
fn points_between_the_samples_of_their_prim_move_while_another_prim_has_a_sample() {
    let (_folder, at) = folder();
    write_usd(&at("a.usda"), " = [2]");
    let mut cache = CurveCache::open(&at("a.usda"), Unit::Auto, UpAxis::Auto, false).expect("curves");
    assert_eq!(cache.times(), [0.0, 0.5, 1.0]);
    let mut points = Vec::new();
    for (secs, wanted) in [
        (0.0, [Vec3::ZERO, Vec3::Y]),
        (0.25, [Vec3::X, Vec3::new(0.0, 1.5, 0.0)]),
        (0.5, [2.0 * Vec3::X, Vec3::new(0.0, 2.0, 0.0)]),
        (1.0, [4.0 * Vec3::X, Vec3::new(0.0, 3.0, 0.0)]),
    ] {
        cache.points_at(secs, &mut points).expect("a time");
        let off = points[0].distance(wanted[0]).max(points[1].distance(wanted[1]));
        println!("{secs} s: {off} m off");
        assert!(off < 1e-6, "{secs} s: {points:?}");
    }
    // Control: the value that is held until the next sample of its own prim is 2 m away.
    cache.points_at(0.5, &mut points).expect("a time");
    assert!(points[0].distance(Vec3::ZERO) > 1.9);
    assert!(points[2].distance(2.0 * Vec3::X) < 1e-6, "{points:?}");
}

#[test]
fn an_archive_that_states_its_unit_is_not_guessed() {
    let (_folder, at) = folder();
    let own = format!("_ai_Application=Lovelock 1;_ai_Description={METRES_Y_UP}");
    for (name, metadata, stated) in
        [("own.abc", own.as_str(), true), ("other.abc", "_ai_Description=inches", false)]
    {
        let path = at(name);
        write_abc(&path, &[40, 40], metadata);
        let hair = load_hair(&path).expect("hair");
        assert_eq!(hair.is_in_metres, stated, "{name}");
        // 0.1 units between points, 39 of them: nearly 9 m long, which is no length of hair.
        let guessed = guess_units(&hair);
        assert_eq!(guessed.metres_per_unit == 1.0, stated, "{name}: {guessed:?}");
        let cache = CurveCache::open(&path, Unit::Auto, UpAxis::Auto, false).expect("curves");
        let [unit, up] = [&cache.notes()[0], &cache.notes()[1]];
        assert_eq!(
            unit.contains("read from the file") && up.contains("read from the file"),
            stated,
            "{unit} {up}"
        );
        assert_eq!(unit.contains("guessed"), !stated, "{unit}");
        let set = CurveCache::open(&path, Unit::Centimetre, UpAxis::Z, false).expect("curves");
        assert_eq!(set.notes()[..2], ["Unit: one centimetre, as set.", "Up axis: Z, as set."]);
    }
}

/// A stage of one curve with lines of metadata and of the prim.
fn write_stage(path: &Path, metadata: &str, lines: &str) {
    let text = format!(
        "#usda 1.0\n(\n{metadata})\ndef BasisCurves \"a\"\n{{\n uniform token type = \"linear\"\n \
         int[] curveVertexCounts = [2]\n{lines}}}\n"
    );
    std::fs::write(path, text).expect("a file");
}

const STILL: &str = " point3f[] points = [(1, 0, 0), (2, 0, 0)]\n";

#[test]
fn curves_under_a_turning_transform_move_along_circles() {
    let (_folder, at) = folder();
    let turn = " float xformOp:rotateZ.timeSamples = { 0: 0, 10: 90 }\n \
                uniform token[] xformOpOrder = [\"xformOp:rotateZ\"]\n";
    let metadata = " metersPerUnit = 1\n upAxis = \"Y\"\n timeCodesPerSecond = 10\n";
    write_stage(&at("turns.usda"), metadata, &format!("{STILL}{turn}"));
    let mut cache = CurveCache::open(&at("turns.usda"), Unit::Auto, UpAxis::Auto, false).expect("curves");
    assert_eq!(cache.times(), [0.0, 1.0]);
    let mut points = Vec::new();
    for (secs, degrees) in [(-1.0, 0.0_f32), (0.0, 0.0), (0.5, 45.0), (0.25, 22.5), (1.0, 90.0), (2.0, 90.0)]
    {
        cache.points_at(secs, &mut points).expect("a time");
        let (sin, cos) = degrees.to_radians().sin_cos();
        for (radius, point) in [1.0_f32, 2.0].into_iter().zip(&points) {
            let wanted = radius * Vec3::new(cos, sin, 0.0);
            assert!(point.distance(wanted) < 1e-5, "{secs} s: {point}, not {wanted}");
        }
    }
    // The control: half-way on the chord the outer point would be 0.59 m nearer to the axis.
    let chord = 0.5 * (2.0 * Vec3::X + 2.0 * Vec3::Y);
    cache.points_at(0.5, &mut points).expect("a time");
    assert!(points[1].distance(chord) > 0.5, "{points:?}");
}

#[test]
fn a_unit_that_a_stage_does_not_state_is_not_said_to_be_read_from_it() {
    let (_folder, at) = folder();
    let moves = " point3f[] points.timeSamples = { 0: [(1, 0, 0), (2, 0, 0)], 1: [(1, 1, 0), (2, 1, 0)] }\n";
    for (name, metadata, of_unit, of_up) in [
        ("both.usda", " metersPerUnit = 0.01\n upAxis = \"Y\"\n", true, true),
        ("up.usda", " upAxis = \"Y\"\n", false, true),
        ("unit.usda", " metersPerUnit = 0.01\n", true, false),
    ] {
        write_stage(&at(name), metadata, moves);
        let cache = CurveCache::open(&at(name), Unit::Auto, UpAxis::Auto, false).expect("curves");
        let [unit, up] = [&cache.notes()[0], &cache.notes()[1]];
        for (note, stated) in [(unit, of_unit), (up, of_up)] {
            assert_eq!(note.contains("read from the file"), stated, "{name}: {note}");
            assert_eq!(note.contains("states none"), !stated, "{name}: {note}");
        }
        assert!(of_unit || unit.contains("centimetre"), "{unit}");
        assert!((cache.hair().points[1].x - 0.02).abs() < 1e-6, "the same unit in each of them");
    }
}

#[test]
fn curves_that_stay_need_no_rate() {
    let (_folder, at) = folder();
    let metadata = " metersPerUnit = 1\n timeCodesPerSecond = 0\n";
    write_stage(&at("still.usda"), metadata, STILL);
    let motion = CurveMotion::of(&at("still.usda"));
    assert!(matches!(motion, CurveMotion::Still), "{motion:?}");
    // The control: with two times the rate matters.
    let moves = " point3f[] points.timeSamples = { 0: [(1, 0, 0), (2, 0, 0)], 1: [(1, 1, 0), (2, 1, 0)] }\n";
    write_stage(&at("moves.usda"), metadata, moves);
    let said = CurveMotion::of(&at("moves.usda")).problem().expect("a reason");
    assert!(said.contains("timeCodesPerSecond 0"), "{said}");
}

/// An archive of one object of hanging strands with that axis up, as a program writes it.
fn write_hanging(path: &Path, up: usize, metadata: &str) {
    let mut writer = ArchiveWriter::create(std::fs::File::create(path).expect("a file")).expect("a file");
    let times = writer.add_times(Times::uniform(0.5, 0.0));
    let point = |strand: i32, k: i32| {
        let mut point = [0.01 * (strand % 10) as f32; 3];
        point[(up + 1) % 3] = 0.013 * (strand / 10) as f32;
        point[up] = -0.1 * k as f32;
        point
    };
    let at = (0..100).flat_map(|strand| (0..4).map(move |k| (strand, k)));
    let bytes: Vec<u8> = at.flat_map(|(strand, k)| point(strand, k)).flat_map(f32::to_le_bytes).collect();
    let (mut points, mut counts) = (Samples::array(POINT, times), Samples::array(INT, times));
    for _ in 0..2 {
        points.push(writer.store(POINT, &bytes).expect("a sample"));
        let each: Vec<u8> = std::iter::repeat_n(4_i32, 100).flat_map(i32::to_le_bytes).collect();
        counts.push(writer.store(INT, &each).expect("a sample"));
    }
    finish(writer, metadata, [points, counts]);
}

#[test]
fn the_axis_of_curves_over_time_is_guessed_and_a_known_program_has_its_own() {
    let (_folder, at) = folder();
    for (name, up, wanted) in [("x.abc", 0, UpAxis::X), ("y.abc", 1, UpAxis::Y), ("z.abc", 2, UpAxis::Z)] {
        write_hanging(&at(name), up, "");
        let cache = CurveCache::open(&at(name), Unit::Auto, UpAxis::Auto, false).expect("curves");
        assert!(
            cache.notes()[1].starts_with(&format!("Up axis: {}, guessed", wanted.label())),
            "{:?}",
            cache.notes()
        );
        let strand = cache.hair().strand(0);
        assert!(strand[3].y < strand[0].y - 0.1, "{name}: it hangs: {strand:?}");
        assert_eq!(guess_units(&load_hair(&at(name)).expect("hair")).up, wanted, "{name}");
    }
    // Without strands that show anything, the program decides; an unknown one leaves it in doubt.
    for (program, unit, sure) in [
        ("Maya 2024", Unit::Centimetre, true),
        ("Blender", Unit::Metre, true),
        ("Some tool", Unit::Metre, false),
    ] {
        let path = at("written.abc");
        write_abc(&path, &[4, 4], &format!("_ai_Application={program}"));
        let hair = load_hair(&path).expect("hair");
        let guess = guess_units(&hair);
        assert_eq!(guess.up == UpAxis::Y && !guess.is_up_in_doubt(), sure, "{program}: {guess:?}");
        assert_eq!(hair.written_unit, sure.then_some(unit), "{program}");
    }
}
