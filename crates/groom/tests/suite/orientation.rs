//! The guessed axes of hair files: grooms in all rotations, in several formats, and what leaves them in doubt.

use std::f32::consts::PI;
use std::io::Cursor;

use crate::common::{YukselFile, data_dir};
use glam::{Mat3, Vec3};
use lovelock_alembic::{ArchiveWriter, CompoundTree, DataType, ObjectTree, Pod, Samples};
use lovelock_groom::{
    Facing, GroomSettings, HAIR_FORMATS, HairFile, ImportSettings, NoObstacle, PlainHead, Preset, UnitGuess,
    UpAxis, grow, guess_units, hair_info, load_hair, load_hair_bytes,
};

type Strands = Vec<Vec<Vec3>>;

/// The 24 rotations that map axes to axes.
fn rotations() -> Vec<Mat3> {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
    let pairs = axes.into_iter().flat_map(|x| axes.into_iter().map(move |y| (x, y)));
    pairs.filter(|(x, y)| x.dot(*y) == 0.0).map(|(x, y)| Mat3::from_cols(x, y, x.cross(y))).collect()
}

fn axis(up: Vec3) -> UpAxis {
    let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let at = axes.into_iter().position(|axis| axis.distance(up) < 1e-3).expect("a rotation of axes");
    UpAxis::AXES[at]
}

fn face(forward: Vec3) -> Facing {
    let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let at = axes.into_iter().position(|axis| axis.distance(forward) < 1e-3).expect("a rotation of axes");
    Facing::AXES[at]
}

/// A `.hair` file of these strands as they are.
fn dot_hair(strands: &Strands) -> HairFile {
    let strands = strands.iter().map(|strand| strand.iter().map(Vec3::to_array).collect()).collect();
    load_hair_bytes("a.hair", &YukselFile::new(strands).bytes()).expect("hair")
}

/// A USC-HairSalon `.data` file of these strands as they are.
fn dot_data(strands: &Strands) -> HairFile {
    let mut bytes = (strands.len() as i32).to_le_bytes().to_vec();
    for strand in strands {
        bytes.extend((strand.len() as i32).to_le_bytes());
        bytes.extend(strand.iter().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes));
    }
    load_hair_bytes("a.data", &bytes).expect("hair")
}

/// An Alembic archive of these strands as they are.
fn alembic(strands: &Strands) -> HairFile {
    let (point, int) = (DataType::new(Pod::F32, 3), DataType::new(Pod::I32, 1));
    let mut writer = ArchiveWriter::create(Cursor::new(Vec::new())).expect("memory");
    let mut store = |ty, bytes: Vec<u8>| {
        let mut samples = Samples::array(ty, 0);
        samples.push(writer.store(ty, &bytes).expect("memory"));
        samples
    };
    let counts = strands.iter().flat_map(|strand| (strand.len() as i32).to_le_bytes()).collect();
    let points = strands.iter().flatten().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes).collect();
    let (counts, points) = (store(int, counts), store(point, points));
    // Linear curves.
    let mut basis = Samples::scalar(DataType::new(Pod::U8, 4), 0);
    basis.push(writer.store(basis.ty, &[1, 0, 0, 0]).expect("memory"));
    let (mut schema, mut properties) = (CompoundTree::default(), CompoundTree::default());
    schema.samples("P", "geoScope=vtx", points);
    schema.samples("nVertices", "", counts);
    schema.samples("curveBasisAndType", "", basis);
    properties.compound(".geom", "", schema);
    let (name, metadata) = ("hair".to_owned(), "schema=AbcGeom_Curve_v2".to_owned());
    let object = ObjectTree { name, metadata, properties, children: Vec::new() };
    let archive = writer.finish("", vec![object]).expect("memory").0.into_inner();
    load_hair_bytes("a.abc", &archive).expect("hair")
}

/// The points of `hair` in a text format that is written as they are.
fn written(hair: &HairFile, extension: &str) -> HairFile {
    let format = HAIR_FORMATS.into_iter().find(|format| format.extensions.contains(&extension));
    let write = format.and_then(|format| format.write).expect("a format that is written");
    load_hair_bytes(&format!("a.{extension}"), &write(hair).expect("a file")).expect("hair")
}

/// Outcomes of guesses about files whose axes are known.
#[derive(Debug, Default, PartialEq, Eq)]
struct Tally {
    right: usize,
    doubted: usize,
    wrong: usize,
}

impl Tally {
    fn add(&mut self, guess: &UnitGuess, up: UpAxis) {
        match guess {
            guess if guess.is_up_in_doubt() => self.doubted += 1,
            guess if guess.up == up => self.right += 1,
            _ => self.wrong += 1,
        }
    }
}

/// Guesses the up axis of strands with Y up in all 24 rotations, in `formats` formats of four.
fn tally(strands: &Strands, formats: usize) -> Tally {
    let mut tally = Tally::default();
    for (k, rotation) in rotations().into_iter().enumerate() {
        let turned: Strands =
            strands.iter().map(|strand| strand.iter().map(|&p| rotation * p).collect()).collect();
        let up = axis(rotation * Vec3::Y);
        let data = dot_data(&turned);
        tally.add(&guess_units(&data), up);
        if formats > 1 {
            tally.add(&guess_units(&dot_hair(&turned)), up);
        }
        // Every up axis once in the formats of text, which are slower.
        if formats > 2 && k % 4 == 0 {
            tally.add(&guess_units(&written(&data, "obj")), up);
            tally.add(&guess_units(&written(&data, "pbrt")), up);
        }
    }
    tally
}

fn strands_of(hair: &HairFile, most: usize) -> Strands {
    let step = hair.strands().div_ceil(most);
    (0..hair.strands()).step_by(step).map(|strand| hair.strand(strand).to_vec()).collect()
}

/// The guides of a preset on a plain head, Y up, the face toward +Z.
fn preset(preset: Preset) -> Strands {
    let settings = GroomSettings { wisps: 90, strands_per_wisp: 2, ..GroomSettings::preset(preset) };
    let style = grow(&settings, &PlainHead.scalp(24), &NoObstacle).expect("a hairstyle");
    let per = style.guides.points_per_guide;
    (0..style.guides.count()).map(|g| (0..per).map(|k| style.guides.point(g, k)).collect()).collect()
}

/// Short hairs along the normals of a ball of radius 0.1 m, down to `lowest` of its height from -1 to 1.
fn fur(lowest: f32, length: f32) -> Strands {
    (0..600)
        .map(|i| {
            let height = 1.0 - (1.0 - lowest) * (i as f32 + 0.5) / 600.0;
            let angle = i as f32 * PI * (3.0 - 5.0_f32.sqrt());
            let across = (1.0 - height * height).sqrt();
            let out = Vec3::new(across * angle.cos(), height, across * angle.sin());
            (0..4).map(|k| out * (0.1 + length * k as f32 / 3.0)).collect()
        })
        .collect()
}

/// The coat of a four-legged animal that stands along Z, of hair of this length combed toward its tail, or hanging from it.
fn coat(length: f32, hangs: bool) -> Strands {
    (0..800)
        .map(|i| {
            let along = i as f32 / 800.0 * 2.0 - 1.0;
            let angle = PI * (-0.7 + 1.4 * ((i * 37) % 101) as f32 / 100.0);
            let thick = 0.25 * (1.0 - along * along).sqrt().max(0.3);
            let out = Vec3::new(angle.sin(), angle.cos(), 0.0);
            let root = Vec3::new(0.0, 0.8, 0.8 * along) + thick * out;
            let flow = if hangs { Vec3::new(0.0, -1.0, -0.2) } else { Vec3::new(0.0, -0.15, -1.0) };
            (0..6).map(|k| root + (flow + 0.1 * out) * length * k as f32 / 5.0).collect()
        })
        .collect()
}

#[test]
fn presets_in_every_rotation_and_four_formats_are_right_or_in_doubt() {
    for style in Preset::ALL {
        let tally = tally(&preset(style), 4);
        println!("{}: {tally:?}", style.id());
        assert_eq!(tally.wrong, 0, "{}: {tally:?}", style.id());
        assert!(tally.right > 55, "{}: {tally:?}", style.id());
    }
}

#[test]
fn one_real_groom_has_one_orientation_in_every_format() {
    let Some(data) = data_dir() else { return };
    let strands = strands_of(&load_hair(&data.join("hair/yuksel/straight.hair")).expect("hair"), 300);
    let (hair, data) = (dot_hair(&strands), dot_data(&strands));
    let archive = alembic(&strands);
    for (name, file) in [
        ("hair", &hair),
        ("data", &data),
        ("obj", &written(&data, "obj")),
        ("pbrt", &written(&data, "pbrt")),
        ("abc", &archive),
    ] {
        let guess = guess_units(file);
        assert_eq!((guess.up, guess.facing), (UpAxis::Z, Facing::PlusY), "{name}: {guess:?}");
        assert!(!guess.is_up_in_doubt() && guess.facing_confidence > 0.8, "{name}: {guess:?}");
    }
}

#[test]
fn real_grooms_in_every_rotation_are_right_or_in_doubt() {
    let Some(data) = data_dir() else { return };
    let z_up = Mat3::from_cols(Vec3::NEG_X, Vec3::Z, Vec3::Y);
    for (name, from_file, is_clear) in [
        ("yuksel/straight.hair", z_up, true),
        ("tressfx/sintel_16pt.tfx", Mat3::IDENTITY, true),
        ("tressfx/sintel_vk.tfx", Mat3::IDENTITY, true),
        ("tressfx/side.tfx", Mat3::IDENTITY, true),
        ("tressfx/back.tfx", Mat3::IDENTITY, false),
        ("tressfx/front_top.tfx", Mat3::IDENTITY, false),
        ("tressfx/Ratboy_mohawk.tfx", Mat3::IDENTITY, false),
        ("tressfx/Ratboy_mohawk_v40.tfx", Mat3::IDENTITY, false),
        ("tressfx/TestHair1.tfx", Mat3::IDENTITY, false),
        ("gltf_lines/sintel_LINES.glb", Mat3::IDENTITY, true),
        ("gltf_lines/sintel_LINE_STRIP_x228.glb", Mat3::IDENTITY, true),
        ("pbrt/straight_300.pbrt", z_up, true),
    ] {
        let file = load_hair(&data.join("hair").join(name)).expect(name);
        let mut strands = strands_of(&file, 500);
        strands.iter_mut().flatten().for_each(|point| *point = from_file * *point);
        let tally = tally(&strands, 2);
        println!("{name}: {tally:?}");
        assert_eq!(tally.wrong, 0, "{name}: {tally:?}");
        assert_eq!(tally.right >= 40, is_clear, "{name}: {tally:?}");
    }
}

#[test]
fn symmetric_balls_and_combed_coats_are_doubted() {
    // Fur all around shows nothing: only the custom of the format is left, which is no certainty.
    for length in [0.01, 0.1, 0.3] {
        assert_eq!(tally(&fur(-1.0, length), 2).doubted, 48, "{length} m");
    }
    // A short coat that is combed toward the tail.
    let combed = tally(&coat(0.05, false), 2);
    assert_eq!((combed.right, combed.wrong), (0, 0), "{combed:?}");
    // The controls: a cap of fur, and long hair that hangs.
    let cap = tally(&fur(0.0, 0.01), 2);
    assert!(cap.right >= 16 && cap.wrong == 0, "{cap:?}");
    let hanging = tally(&coat(0.5, true), 2);
    println!("combed {combed:?}, cap {cap:?}, hanging {hanging:?}");
    assert_eq!(hanging.wrong, 0, "{hanging:?}");
    assert!(hanging.right > 0, "{hanging:?}");
}

/// Strands of this length on the top and the back of a head, Y up, the face toward +Z, which bend as `pull` says.
fn bent(length: f32, pull: Vec3) -> Strands {
    let size = Vec3::new(0.075, 0.095, 0.09);
    let normal = |i: usize| {
        let height = 1.0 - 2.0 * (i as f32 + 0.5) / 900.0;
        let (angle, across) = (i as f32 * PI * (3.0 - 5.0_f32.sqrt()), (1.0 - height * height).sqrt());
        Vec3::new(across * angle.cos(), height, across * angle.sin())
    };
    let is_scalp = |n: &Vec3| (n.y > 0.05 && !(n.z > 0.55 && n.y < 0.6)) || (n.y > -0.5 && n.z < -0.3);
    let strand = |n: Vec3| {
        let (mut at, mut along) = (size * n, n);
        let step = length / 15.0;
        let points = (0..15).map(move |_| {
            along = (along + pull * (4.0 / 15.0)).normalize_or(n);
            at += step * along;
            // Outside of the head.
            let out = (at / size).length();
            if out < 1.02 {
                at *= 1.02 / out;
            }
            at
        });
        std::iter::once(size * n).chain(points).collect()
    };
    (0..900).map(normal).filter(is_scalp).map(strand).collect()
}

#[test]
fn hair_that_contradicts_the_dome_of_its_roots_is_doubted() {
    for (what, length, pull) in [
        ("stands up", 0.2, Vec3::new(0.0, 0.5, 0.0)),
        ("bends up", 0.2, Vec3::new(0.0, 1.0, 0.0)),
        ("a head that hangs", 0.4, Vec3::new(0.0, 2.0, 0.0)),
        ("blown back", 0.4, Vec3::new(0.0, -0.1, -1.0)),
        ("blown to a side", 0.4, Vec3::new(1.0, -0.2, 0.0)),
    ] {
        let tally = tally(&bent(length, pull), 2);
        println!("{what}: {tally:?}");
        assert_eq!((tally.doubted, tally.wrong), (48, 0), "{what}: {tally:?}");
    }
    // Negative control: the same head with hair that hangs.
    for length in [0.2, 0.4] {
        let hanging = tally(&bent(length, Vec3::NEG_Y), 2);
        assert_eq!((hanging.right, hanging.wrong), (48, 0), "{length} m: {hanging:?}");
    }
}

#[test]
fn a_few_strands_are_no_certainty() {
    let strands = |count: usize| -> Strands {
        let hang = |i: usize| (0..4).map(|k| Vec3::new(i as f32, 0.0, -20.0 * k as f32)).collect();
        (0..count).map(hang).collect()
    };
    assert!(guess_units(&dot_data(&strands(2))).is_up_in_doubt());
    let many = guess_units(&dot_data(&strands(60)));
    assert_eq!((many.up, many.is_up_in_doubt()), (UpAxis::Z, false), "{many:?}");
}

#[test]
fn the_face_is_found_in_every_rotation_or_in_doubt() {
    let strands = preset(Preset::Smooth);
    let (mut right, mut doubted) = (0, 0);
    for rotation in rotations() {
        let turned: Strands =
            strands.iter().map(|strand| strand.iter().map(|&p| rotation * p).collect()).collect();
        let guess = guess_units(&dot_data(&turned));
        assert_eq!(guess.up, axis(rotation * Vec3::Y));
        if guess.facing == face(rotation * Vec3::Z) {
            right += 1;
        } else {
            assert!(guess.facing_confidence < 0.9, "{guess:?}");
            doubted += 1;
        }
    }
    println!("face: {right} right, {doubted} in doubt");
    assert!(right >= 20, "{right} right");
}

#[test]
fn a_stated_axis_stays_and_a_clear_contradiction_is_noted() {
    let stage = |up: Vec3| {
        let strands = preset(Preset::Smooth);
        let turn = if up == Vec3::Y { Mat3::IDENTITY } else { Mat3::from_cols(Vec3::Y, Vec3::Z, Vec3::X) };
        let counts: Vec<String> = strands.iter().map(|strand| strand.len().to_string()).collect();
        let points: Vec<String> = (strands.iter().flatten())
            .map(|&p| turn * p)
            .map(|p| format!("({}, {}, {})", p.x, p.y, p.z))
            .collect();
        let text = format!(
            "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\ndef BasisCurves \"a\"\n{{\n uniform token type = \"linear\"\n\
             int[] curveVertexCounts = [{}]\npoint3f[] points = [{}]\n}}\n",
            counts.join(", "),
            points.join(", ")
        );
        load_hair_bytes("a.usda", text.as_bytes()).expect("hair")
    };
    let contradicting = guess_units(&stage(Vec3::Z));
    assert_eq!((contradicting.up, contradicting.contradicting_up), (UpAxis::Y, Some(UpAxis::Z)));
    let note = contradicting.note_on_up().expect("a note");
    assert!(note.contains("Y points up") && note.contains("as if Z did") && note.contains("--up"), "{note}");
    // It can be overruled.
    let settings = ImportSettings { up: UpAxis::Z, ..ImportSettings::default() };
    assert_eq!(hair_info(&stage(Vec3::Z), &settings).up, "z");
    assert!(hair_info(&stage(Vec3::Z), &settings).notes.is_empty());
    // The control: a stage that is right.
    let agreeing = guess_units(&stage(Vec3::Y));
    assert_eq!((agreeing.up, agreeing.contradicting_up, agreeing.note_on_up()), (UpAxis::Y, None, None));
}

#[test]
fn doubt_is_a_note_with_the_option_that_settles_it() {
    let ball = dot_data(&fur(-1.0, 0.02));
    let info = hair_info(&ball, &ImportSettings::default());
    assert!(info.notes.iter().any(|note| note.contains("in doubt") && note.contains("--up")), "{info:?}");
    assert!(info.up_confidence < 0.9);
    let set = hair_info(&ball, &ImportSettings { up: UpAxis::MinusX, ..ImportSettings::default() });
    assert_eq!((set.up.as_str(), set.up_confidence), ("-x", 1.0));
    assert!(!set.notes.iter().any(|note| note.contains("--up")), "{set:?}");
}

#[test]
fn every_up_axis_stands_upright_when_it_is_set() {
    let strands = preset(Preset::Smooth);
    for rotation in rotations() {
        let turned: Strands =
            strands.iter().map(|strand| strand.iter().map(|&p| rotation * p).collect()).collect();
        let settings = ImportSettings {
            unit: lovelock_groom::Unit::Metre,
            up: axis(rotation * Vec3::Y),
            facing: face(rotation * Vec3::Z),
            ..ImportSettings::default()
        };
        let upright = dot_hair(&turned).in_metres(&settings);
        for (a, b) in upright.points.iter().zip(strands.iter().flatten()) {
            assert!(a.distance(*b) < 1e-6, "{settings:?}: {a}, not {b}");
        }
    }
}
