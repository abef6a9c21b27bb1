//! Damaged hair files of every format give hair or an error, never a panic.

use crate::common::{YukselFile, data_dir};

use std::io::Write;
use std::path::Path;

use lovelock_groom::{
    HairFile, HairFileError, HairFormat, ImportSettings, guess_units, hair_info, load_hair_bytes,
};
use lovelock_testkit::fuzz::{Counts, damaged};
use openusd::usdc::CrateWriter;

/// Two linear strands with colours and a cubic one, in a group that moves.
const STAGE: &str = "#usda 1.0\n(\n metersPerUnit = 0.01\n upAxis = \"Z\"\n)\ndef Xform \"w\"\n{\n\
    double3 xformOp:translate = (10, 0, 100)\nuniform token[] xformOpOrder = [\"xformOp:translate\"]\n\
    def BasisCurves \"a\"\n{\nuniform token type = \"linear\"\nint[] curveVertexCounts = [2, 3]\n\
    point3f[] points = [(0, 0, 1), (0, 0, 2), (1, 0, 0), (1, 1, 0), (1, 1, 1)]\n\
    float[] widths = [0.5, 0.25] (\n interpolation = \"uniform\"\n)\n\
    color3f[] primvars:displayColor = [(0.2, 0.1, 0.05)]\n}\n\
    def BasisCurves \"b\"\n{\nuniform token basis = \"bspline\"\nuniform token wrap = \"pinned\"\n\
    int[] curveVertexCounts = [4]\npoint3f[] points = [(0, 0, 0), (0, 1, 0), (0, 2, 1), (0, 3, 0)]\n}\n}\n";

const OBJ: &str = "# lines\no hair\nv 0 0 0 1 0 0\nv 0 1 0 1 0 0\nv 0 2 0 1 0 0\nv 0 2 1 1 0 0\nl 1 2\nl 2 3\nl -4 -3 -2 -1\nf 1 2 3\n";

const PBRT: &str = "Translate 1 2 3\nAttributeBegin\nScale 2 2 2 Rotate 30 0 0 1\nObjectBegin \"a\"\nShape \"curve\" \"point3 P\" [ 0 0 0 \
    0 1 0 0 2 1 1 3 0 ] \"float width0\" 0.1\nObjectEnd\nObjectInstance \"a\"\nAttributeEnd # comment\nShape \"curve\" \
    \"string basis\" \"bspline\" \"integer degree\" [ 2 ] \"point P\" [ 0 0 0 0 1 0 1 2 0 2 3 1 ]\nInclude \"no.pbrt\"\n";

/// A stage as a binary crate.
fn usd_crate() -> Vec<u8> {
    let data = openusd::usda::parse(STAGE).expect("a stage");
    let mut bytes = std::io::Cursor::new(Vec::new());
    CrateWriter::write(&data, &mut bytes).expect("a crate");
    bytes.into_inner()
}

/// Strands of different lengths with every array.
fn yuksel() -> Vec<u8> {
    let strand = |points: usize, x: f32| (0..points).map(|i| [x, 0.5, -(i as f32)]).collect();
    let mut file = YukselFile::new(vec![strand(4, 0.0), strand(7, 1.0), strand(2, 2.0)]);
    file.thickness = Some(|i| i as f32);
    file.transparency = Some(|_| 0.5);
    file.colours = Some(|i| [i as f32 * 0.1, 0.0, 1.0]);
    file.uvs = true;
    file.bytes()
}

fn hair(points: usize) -> HairFile {
    let strand = |x: f32| (0..points).map(|i| [x, 0.5, -(i as f32)]).collect();
    let mut file = YukselFile::new(vec![strand(0.0), strand(1.0), strand(2.0)]);
    file.thickness = Some(|i| 0.01 * i as f32 + 0.01);
    file.colours = Some(|i| [i as f32 * 0.05, 0.0, 1.0]);
    load_hair_bytes("a.hair", &file.bytes()).expect("hair").in_metres(&ImportSettings::default())
}

fn written(extension: &str) -> Vec<u8> {
    let format = HairFormat::of_path(Path::new("a").with_extension(extension).as_path()).expect("a format");
    format.write.expect("a format that is written")(&hair(5)).expect(extension)
}

/// A `.tfx` of version 3: positions of three floats at byte 296.
fn tfx3() -> Vec<u8> {
    let mut bytes: Vec<u8> = 3.0_f32.to_le_bytes().to_vec();
    bytes.extend([3_u32, 4, 2, 0].into_iter().flat_map(u32::to_le_bytes));
    bytes.resize(144, 0);
    bytes.extend(296_u32.to_le_bytes());
    bytes.resize(296, 0);
    bytes.extend((0..36).flat_map(|i| (i as f32 * i as f32).to_le_bytes()));
    bytes
}

fn usc(words_per_point: usize) -> Vec<u8> {
    let mut bytes = 3_i32.to_le_bytes().to_vec();
    for strand in 0..3 {
        bytes.extend((strand + 2_i32).to_le_bytes());
        for i in 0..(strand + 2) as usize * words_per_point {
            bytes.extend((1.0 + i as f32 * 0.1).to_le_bytes());
        }
    }
    bytes
}

fn packed(text: &str) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(text.as_bytes()).expect("memory");
    encoder.finish().expect("memory")
}

/// Reads bytes and checks what a `HairFile` guarantees. Returns whether they were accepted.
fn reads(name: &str, bytes: &[u8]) -> bool {
    let file = match load_hair_bytes(name, bytes) {
        Ok(file) => file,
        Err(error) => {
            let line = error.to_string();
            assert!(!line.contains('\n') && line.len() < 2000, "{line}");
            assert!(!matches!(error, HairFileError::Io { .. }) || line.starts_with(name), "{line}");
            return false;
        }
    };
    assert!(file.strands() > 0 && file.first_point[0] == 0);
    assert_eq!(file.first_point[file.strands()] as usize, file.points.len());
    for strand in 0..file.strands() {
        let points = file.strand(strand);
        assert!(points.len() >= 2 && points.iter().all(|p| p.is_finite()));
        assert!(points.array_windows().all(|[a, b]| a != b));
    }
    let points = file.points.len();
    assert!(file.thickness.as_ref().is_none_or(|values| values.len() == points));
    assert!(file.colours.as_ref().is_none_or(|values| values.len() == points));
    // A small file does not become a huge one: a scene may repeat what it holds.
    assert!(points <= 1 << 26, "{points} points of {} bytes", bytes.len());
    let guess = guess_units(&file);
    assert!(guess.metres_per_unit.is_finite() && guess.metres_per_unit > 0.0, "{guess:?}");
    let info = hair_info(&file, &ImportSettings::default());
    assert!(info.bounds_m.min.is_finite() && info.bounds_m.max.is_finite(), "{info:?}");
    true
}

/// Runs the damaged copies of files of one format through its reader.
fn run(name: &str, sound: &[Vec<u8>]) -> Counts {
    damaged(name, sound, 3000, |bytes| reads(&format!("a.{name}"), bytes))
}

#[test]
fn damaged_hair_yuksel() {
    run("hair", &[yuksel(), written("hair")]);
}

#[test]
fn damaged_hair_of_other_programs() {
    let Some(data) = data_dir() else { return };
    let names =
        ["tressfx/sintel_vk.tfx", "tressfx/back.tfx", "broken/variable_odd.hair", "broken/allflags.hair"];
    let files = names.map(|name| std::fs::read(data.join("hair").join(name)).expect(name));
    damaged("other hair", &files, 200, |bytes| reads("a.hair", bytes));
}

#[test]
fn damaged_hair_tressfx() {
    run("tfx", &[written("tfx"), tfx3()]);
}

#[test]
fn damaged_hair_usd_text() {
    run("usda", &[STAGE.into()]);
}

#[test]
fn damaged_hair_usd_crate() {
    run("usdc", &[usd_crate()]);
}

#[test]
fn damaged_hair_gltf() {
    // Measured: 2.8 % of 31.9 million.
    run("gltf", &[written("gltf")]).assert_mixed(0.005);
}

#[test]
fn damaged_hair_glb() {
    // Measured: 2.8 % of 36 million.
    run("glb", &[written("glb")]).assert_mixed(0.005);
}

#[test]
fn damaged_hair_obj() {
    // Measured: 9.7 % of 28.8 million.
    run("obj", &[OBJ.into(), written("obj")]).assert_mixed(0.02);
}

#[test]
fn damaged_hair_pbrt() {
    run("pbrt", &[PBRT.into(), written("pbrt")]);
}

#[test]
fn damaged_hair_compressed() {
    // Measured: 0.47 % of 9.2 million, because most damage breaks the checksum.
    run("gz", &[packed(PBRT)]).assert_mixed(0.0005);
}

#[test]
fn damaged_hair_usc() {
    run("data", &[usc(3), usc(4)]);
}

#[test]
fn damaged_hair_headless() {
    let strands = [3_u16, 5, 2];
    let mut bytes = [3_u32.to_le_bytes(), 10_u32.to_le_bytes()].concat();
    bytes.extend(strands.iter().flat_map(|count| count.to_le_bytes()));
    bytes.extend((0..30).flat_map(|i| (i as f32 * i as f32).to_le_bytes()));
    let counts = run("hair", &[bytes]);
    assert!(counts.accepted > 0, "{counts:?}");
}

#[test]
fn damaged_hair_ct2hair() {
    run("bin", &[usc(7), usc(3)]);
}

#[test]
fn damaged_hair_ply() {
    let text = "ply\nformat ascii 1.0\ncomment a\nelement vertex 6\nproperty float x\nproperty double y\nproperty float z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int strand_id\nend_header\n\
        0 0 0 1 2 3 0\n0 1 0 1 2 3 0\n0 2 1 1 2 3 0\n1 0 0 1 2 3 1\n1 1 0 1 2 3 1\n1 2 0 9 9 9 1\n";
    let lines = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement line 2\n\
        property list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n\
        0 0 0\n0 1 0\n0 2 1\n1 0 0\n2 0 1\n2 2 3\n0 3\n";
    let counts = run("ply", &[written("ply"), text.into(), lines.into()]);
    assert!(counts.accepted > 0, "{counts:?}");
}

#[test]
fn damaged_hair_numpy() {
    let counts = run("npy", &[written("npy")]);
    assert!(counts.accepted > 0, "{counts:?}");
    run("npz", &[written("npz")]);
}
