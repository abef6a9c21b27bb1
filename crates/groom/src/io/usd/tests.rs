use std::io::Cursor;

use openusd::usdc::CrateWriter;

use super::super::{HairFile, HairFileError, load_hair_bytes};
use super::*;

/// Two prims with transforms above them, in centimetres with Z up; the first one is animated.
const STAGE: &str = r#"#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 0.01
    upAxis = "Z"
)

def Xform "World"
{
    double3 xformOp:translate = (10, 0, 100)
    float3 xformOp:scale = (2, 2, 2)
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]

    def BasisCurves "a"
    {
        uniform token type = "linear"
        int[] curveVertexCounts = [2, 3]
        point3f[] points = [(9, 9, 9), (9, 9, 9), (9, 9, 9), (9, 9, 9), (9, 9, 9)]
        point3f[] points.timeSamples = {
            3: [(0, 0, 1), (0, 0, 2), (1, 0, 0), (1, 1, 0), (1, 1, 1)],
            4: [(0, 0, 0), (0, 0, 1), (1, 0, 0), (1, 1, 0), (1, 1, 5)],
        }
        float[] widths = [0.5, 0.25] (
            interpolation = "uniform"
        )
        color3f[] primvars:displayColor = [(0.2, 0.1, 0.05)] (
            interpolation = "constant"
        )
    }

    def BasisCurves "b"
    {
        uniform token basis = "bezier"
        uniform token type = "cubic"
        float xformOp:rotateX = 90
        uniform token[] xformOpOrder = ["!resetXformStack!", "xformOp:rotateX"]
        int[] curveVertexCounts = [4]
        point3f[] points = [(0, 0, 0), (0, 1, 0), (0, 2, 0), (0, 3, 0)]
        float[] widths = [1, 1, 0.5, 0.5]
        color3f[] primvars:displayColor = [(0.4, 0.4, 0.4), (1, 1, 1)] (
            interpolation = "varying"
        )
    }

    def BasisCurves "off" (
        active = false
    )
    {
        int[] curveVertexCounts = [1000000]
    }
}

class BasisCurves "abstract"
{
    int[] curveVertexCounts = [7]
}
"#;

fn crate_of(text: &str) -> Vec<u8> {
    let data = openusd::usda::parse(text).expect("a stage");
    let mut bytes = Cursor::new(Vec::new());
    CrateWriter::write(&data, &mut bytes).expect("a crate");
    bytes.into_inner()
}

fn load(text: &str) -> [Result<HairFile, HairFileError>; 2] {
    [load_hair_bytes("a.usda", text.as_bytes()), load_hair_bytes("a.usda", &crate_of(text))]
}

#[test]
fn text_and_crate_are_read_alike_with_unit_axis_transforms_and_the_first_time() {
    let [text, binary] = load(STAGE).map(|file| file.expect("hair"));
    assert_eq!(text, binary);
    assert_eq!(text.format, FORMAT.label);
    assert_eq!(text.strands(), 3);
    // Time 3: (0, 0, 1) at twice the size, at (10, 0, 100) cm with Z up: 1.02 m high.
    let near = |a: Vec3, b: [f32; 3]| assert!(a.abs_diff_eq(b.into(), 1e-6), "{a} for {b:?}");
    near(text.strand(0)[0], [0.1, 1.02, 0.0]);
    near(text.strand(0)[1], [0.1, 1.04, 0.0]);
    near(text.strand(1)[2], [0.12, 1.02, -0.02]);
    // The second prim resets its ancestors' transforms: y turns to z, which is up.
    assert_eq!(text.strand(2).len(), 9);
    near(text.strand(2)[8], [0.0, 0.03, 0.0]);
    let widths = text.thickness.expect("widths");
    // Half a unit wide at twice the size, in centimetres; then varying from end to end.
    assert!((widths[0] - 0.01).abs() < 1e-7 && (widths[2] - 0.005).abs() < 1e-7, "{widths:?}");
    assert!((widths[5] - 0.01).abs() < 1e-7 && (widths[13] - 0.005).abs() < 1e-7, "{widths:?}");
    let colours = text.colours.expect("colours");
    assert!((colours[0][0] - 0.484_53).abs() < 1e-4 && colours[13][2] > 0.9999, "{colours:?}");
}

#[test]
fn contradictory_files_are_refused_with_a_reason() {
    for (from, to, wanted) in [
        ("[2, 3]", "[2, 4]", "5 points in 2 curves"),
        ("[2, 3]", "[2, 2147483647]", "5 points in 2 curves"),
        ("[2, 3]", "[-2, 7]", "5 points in 2 curves"),
        ("\"linear\"", "\"wavy\"", "wavy curves"),
        ("metersPerUnit = 0.01", "metersPerUnit = 0", "metersPerUnit 0"),
        ("BasisCurves", "Mesh", "no curves"),
        ("float xformOp:rotateX = 90", "float3 xformOp:rotateX = (1, 2, 3)", "xformOp:rotateX of 3 numbers"),
    ] {
        let changed = STAGE.replace(from, to);
        assert_ne!(changed, STAGE, "{from}");
        for file in load(&changed) {
            let error = file.expect_err(to).to_string();
            assert!(error.starts_with("a.usda: ") && error.contains(wanted), "{to}: {error}");
        }
    }
}

#[test]
fn odd_values_are_left_out_with_a_note() {
    let changed = STAGE.replace("[0.5, 0.25]", "[0.5, 0.25, 0.125]");
    for file in load(&changed) {
        let file = file.expect("hair");
        // The other curves have widths, of which these get the mean.
        let widths = file.thickness.expect("widths");
        assert!(widths[..5].iter().all(|width| *width == widths[0] && (0.005..0.01).contains(width)));
        assert!(file.notes.iter().any(|note| note.contains("3 values of widths")), "{:?}", file.notes);
    }
    for file in load(&STAGE.replace("    metersPerUnit = 0.01\n", "")) {
        let file = file.expect("hair");
        assert!(file.notes.iter().any(|note| note.contains("metersPerUnit")), "{:?}", file.notes);
        assert!((file.strand(0)[0].y - 1.02).abs() < 1e-6, "a centimetre");
    }
}

#[test]
fn text_that_would_abort_the_program_is_refused() {
    let deep = format!("#usda 1.0\ndef \"a\" ( customData = {} )", "{ dictionary a = ".repeat(100_000));
    let many = format!("#usda 1.0\ndef \"a\" {{\n{}}}", "int a = 1\n".repeat(200_000));
    let hidden = format!("#usda 1.0\n{}", "def \"a\" { # }\n".repeat(100_000));
    for text in [&deep, &many, &hidden] {
        let error = load_hair_bytes("a.usda", text.as_bytes()).expect_err("too much").to_string();
        assert!(error.contains("more than"), "{error}");
    }
    for broken in [
        "#usda",
        "#usda 1.0\ndef",
        "#usda 1.0\n}",
        "#usda 1.0\n\u{0}",
        "#usda 1.0\ndef \"a\" { int b = [1, }",
    ] {
        let error = load_hair_bytes("a.usda", broken.as_bytes()).expect_err(broken).to_string();
        assert!(!error.contains('\n') && error.starts_with("a.usda: "), "{error}");
    }
}

#[test]
fn a_package_is_read_as_its_stage() {
    let stage = "#usda 1.0\ndef BasisCurves \"a\"\n{\nuniform token type = \"linear\"\nint[] curveVertexCounts = [2]\n\
        point3f[] points = [(0, 0, 0), (0, 1, 0)]\n}\n";
    let package = |entry: &str, method: zip::CompressionMethod| {
        let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        writer.start_file(entry, options).expect("an entry");
        std::io::Write::write_all(&mut writer, stage.as_bytes()).expect("memory");
        writer.finish().expect("memory").into_inner()
    };
    let stored = package("hair.usda", zip::CompressionMethod::Stored);
    for name in ["a.usdz", "a.npz", "a"] {
        let hair = load_hair_bytes(name, &stored).expect(name);
        assert_eq!(
            (hair.strands(), hair.is_in_metres, hair.format.as_str()),
            (1, true, "USD BasisCurves"),
            "{name}"
        );
    }
    for (bytes, words) in [
        (package("hair.usda", zip::CompressionMethod::Deflated), "a compressed stage"),
        (stored[..60].to_vec(), "a stage that is cut"),
        (package("hair.txt", zip::CompressionMethod::Stored), "USD"),
    ] {
        let error = load_hair_bytes("a.usdz", &bytes).expect_err(words).to_string();
        assert!(error.contains(words), "{words}: {error}");
    }
}
