//! USD: known positions of a small character, motion alone, packages, and files that are refused.

use std::fmt::Write;

use glam::{Vec2, Vec3};
use image::ImageFormat;
use lovelock_motion::{
    Alpha, BodySettings, FigureContent, MotionSettings, Wrap, figure_content, load_character,
    load_character_bytes, load_character_bytes_with, load_motion_bytes,
};
use lovelock_testkit::fuzz::damaged;

use crate::common::{assert_near, points_at, reads_character, textured::picture};

/// A figure in centimetres with Z up: `hips` at 1 m, `head` 0.5 m above, and a triangle 0.1 m to the left, in front and above of the
/// head. In one second the hips turn by a quarter to the left, and the shape `open` lifts the third point by 0.1 m. The turn about Z
/// is `(cos 45°, 0, 0, sin 45°)`.
const STAGE: &str = r#"#usda 1.0
(
    metersPerUnit = 0.01
    upAxis = "Z"
    timeCodesPerSecond = 10
    startTimeCode = 5
)
def SkelRoot "figure"
{
    def Skeleton "rig" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {
        uniform token[] joints = ["hips", "hips/head"]
        uniform matrix4d[] bindTransforms = [
            ( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 100, 1) ),
            ( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 150, 1) )
        ]
        rel skel:animationSource = </figure/rig/dance>

        def SkelAnimation "dance"
        {
            uniform token[] joints = ["hips", "hips/head"]
            float3[] translations = [(0, 0, 100), (0, 0, 50)]
            quatf[] rotations.timeSamples = {
                5: [(1, 0, 0, 0), (1, 0, 0, 0)],
                15: [(0.70710678, 0, 0, 0.70710678), (1, 0, 0, 0)],
            }
            half3[] scales = [(1, 1, 1), (1, 1, 1)]
            uniform token[] blendShapes = ["open"]
            float[] blendShapeWeights.timeSamples = {
                5: [0],
                15: [1],
            }
        }
    }

    def Mesh "body" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(10, 0, 150), (0, -10, 150), (0, 0, 160)]
        color3f[] primvars:displayColor = [(0.25, 0.5, 0.75)]
        int[] primvars:skel:jointIndices = [0, 1, 1] (
            elementSize = 1
            interpolation = "vertex"
        )
        float[] primvars:skel:jointWeights = [1, 1, 1] (
            elementSize = 1
            interpolation = "vertex"
        )
        rel skel:skeleton = </figure/rig>
        uniform token[] skel:blendShapes = ["open"]
        rel skel:blendShapeTargets = </figure/body/open>

        def BlendShape "open"
        {
            uniform vector3f[] offsets = [(0, 0, 10)]
            uniform int[] pointIndices = [2]
        }
    }
}
"#;

fn crate_of(text: &str) -> Vec<u8> {
    let data = openusd::usda::parse(text).expect("a stage");
    let mut bytes = std::io::Cursor::new(Vec::new());
    openusd::usdc::CrateWriter::write(&data, &mut bytes).expect("a crate");
    bytes.into_inner()
}

/// A package with one stored file.
fn package(name: &str, content: &[u8]) -> Vec<u8> {
    let mut out = b"PK\x03\x04".to_vec();
    out.extend([20, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    out.extend((content.len() as u32).to_le_bytes());
    out.extend((content.len() as u32).to_le_bytes());
    out.extend((name.len() as u16).to_le_bytes());
    out.extend(5_u16.to_le_bytes());
    out.extend(name.as_bytes());
    out.extend([0; 5]);
    out.extend(content);
    out
}

#[test]
fn a_figure_moves_alike_from_text_crate_and_package() {
    let binary = crate_of(STAGE);
    let packed = package("figure.usdc", &binary);
    for (bytes, format) in
        [(STAGE.as_bytes(), "USD (text)"), (&binary[..], "USD (binary)"), (&packed[..], "USD (package)")]
    {
        let character = load_character_bytes("figure.usd", bytes, None).unwrap_or_else(|e| panic!("{e}"));
        let info = character.info();
        assert_eq!((info.joints, info.skins, info.vertices, info.morph_targets), (2, 1, 3, 1));
        assert_eq!((info.head.as_str(), info.format.as_str()), ("head", format));
        assert_eq!(info.clips[0].name, "dance");
        assert!((info.clips[0].duration_secs - 1.0).abs() < 1e-6);
        assert_eq!(character.body.mesh.colors[0], Vec3::new(0.25, 0.5, 0.75));
        let head = character.body.skeleton.rest_position(character.body.head_joint);
        assert!(head.distance(Vec3::new(0.0, 1.5, 0.0)) < 1e-5, "{head}");
        let (left, front) = (Vec3::new(0.1, 1.5, 0.0), Vec3::new(0.0, 1.5, 0.1));
        assert_near(&character.body.mesh.positions, [left, front, Vec3::new(0.0, 1.6, 0.0)]);
        assert_near(&points_at(&character, 0.0), [left, front, Vec3::new(0.0, 1.6, 0.0)]);
        let back = Vec3::new(0.0, 1.5, -0.1);
        assert_near(&points_at(&character, 1.0_f64.next_down()), [back, left, Vec3::new(0.0, 1.7, 0.0)]);
    }
}

#[test]
fn animation_without_a_body_is_a_motion() {
    let begin = STAGE.find("        def SkelAnimation").expect("it");
    let end = STAGE.find("    def Mesh").expect("it");
    let mut text = STAGE[..STAGE.find("def SkelRoot").expect("it")].to_owned();
    let animation = STAGE[begin..end].trim_end().trim_end_matches('}');
    write!(text, "{animation}").expect("it");
    for bytes in [text.as_bytes(), &crate_of(&text)] {
        let error = load_character_bytes("a.usd", bytes, None).expect_err("no body").to_string();
        assert!(error.contains("0 meshes") && error.contains("Motion file"), "{error}");
        let motion = load_motion_bytes("a.usd", bytes, MotionSettings::default()).expect("a motion");
        assert_eq!((motion.frames, motion.clips.as_slice()), (61, &["dance".to_owned()][..]));
        let mut world = Vec::new();
        motion.world(60, &mut world);
        let head = world.last().expect("a joint");
        assert!(Vec3::from(head.translation).distance(Vec3::new(0.0, 1.5, 0.0)) < 1e-4, "{head:?}");
        let forward = head.transform_vector3(Vec3::Z);
        assert!(forward.distance(Vec3::X) < 1e-4, "{forward}");
    }
}

#[test]
fn what_contradicts_itself_is_refused_with_a_reason() {
    for (from, to, says) in [
        ("[0, 1, 2]\n        point3f", "[0, 1, 3]\n        point3f", "point 3"),
        ("faceVertexCounts = [3]", "faceVertexCounts = [4]", "do not add up"),
        ("faceVertexCounts = [3]", "faceVertexCounts = [-3]", "do not add up"),
        ("jointWeights = [1, 1, 1]", "jointWeights = [1, 1]", "3 joint indices and 2 joint weights"),
        (
            "joints = [\"hips\", \"hips/head\"]\n        uniform",
            "joints = [\"hips\"]\n        uniform",
            "for 1 joints",
        ),
        ("metersPerUnit = 0.01", "metersPerUnit = 0", "metersPerUnit 0"),
        ("def Mesh", "def Cube", "0 meshes"),
    ] {
        let changed = STAGE.replace(from, to);
        assert_ne!(changed, STAGE, "{from}");
        for bytes in [changed.as_bytes(), &crate_of(&changed)] {
            let error = load_character_bytes("a.usd", bytes, None).expect_err(to).to_string();
            assert!(error.starts_with("a.usd: ") && error.contains(says) && !error.contains('\n'), "{error}");
        }
    }
    let error =
        load_character_bytes("a.usdz", &package("a.png", b"x"), None).expect_err("no stage").to_string();
    assert!(error.contains("does not begin with"), "{error}");
    let mut packed = package("a.usdc", b"PXR-USDC");
    packed[8] = 8;
    let error = load_character_bytes("a.usdz", &packed, None).expect_err("compressed").to_string();
    assert!(error.contains("is compressed"), "{error}");
    let cut = &package("a.usda", STAGE.as_bytes())[..200];
    let error = load_character_bytes("a.usdz", cut, None).expect_err("cut").to_string();
    assert!(error.contains("ends within"), "{error}");
}

#[test]
fn joints_above_themselves_and_of_no_size_are_survived() {
    for (from, to) in [
        ("[\"hips\", \"hips/head\"]", "[\"hips/head/hips\", \"hips/head\"]"),
        ("[\"hips\", \"hips/head\"]", "[\"hips\", \"hips\"]"),
        ("(1, 1, 1), (1, 1, 1)", "(0, 0, 0), (0, 0, 0)"),
        (
            "(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 100, 1)",
            "(0, 0, 0, 0), (0, 0, 0, 0), (0, 0, 0, 0), (0, 0, 0, 0)",
        ),
        ("quatf[] rotations.timeSamples", "quatf[] turns.timeSamples"),
    ] {
        let changed = STAGE.replace(from, to);
        assert_ne!(changed, STAGE, "{from}");
        if let Ok(character) = load_character_bytes("a.usda", changed.as_bytes(), None) {
            assert!(points_at(&character, 0.5).iter().all(|p| p.is_finite()), "{to}");
        }
    }
}

fn survives(bytes: &[u8]) -> bool {
    let _ = load_motion_bytes("x.usd", bytes, MotionSettings::default());
    reads_character("x.usd", bytes)
}

#[test]
fn files_cut_anywhere_are_survived() {
    for bytes in [STAGE.as_bytes(), &crate_of(STAGE)] {
        for end in (0..bytes.len()).step_by(13) {
            survives(&bytes[..end]);
        }
    }
}

/// Files of more than 2 GiB are not read into memory, so a longer one shows that the content of a crate is found without its points.
#[test]
fn the_content_of_a_crate_is_found_without_reading_it_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("large.usd");
    let large = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("a file");
        // The rest is a hole, which takes no room on the disk.
        std::fs::OpenOptions::new()
            .write(true)
            .open(&path)
            .and_then(|file| file.set_len(3 << 30))
            .expect("a longer file");
        figure_content(&path)
    };
    assert_eq!(large(&crate_of(STAGE)).expect("a crate"), Some(FigureContent::Body));
    let curves = "#usda 1.0\ndef BasisCurves \"a\"\n{\n int[] curveVertexCounts = [2]\n}\n";
    assert_eq!(large(&crate_of(curves)).expect("a crate"), Some(FigureContent::Curves));
    // The control: text is read whole.
    let error = large(STAGE.as_bytes()).expect_err("too long").to_string();
    assert!(error.contains("must be at most"), "{error}");
}

#[test]
fn damaged_character_usd() {
    let files = [STAGE.as_bytes().to_vec(), crate_of(STAGE), package("a.usdc", &crate_of(STAGE)), packed()];
    damaged("usd figure", &files, 1500, survives);
}

/// The figure with a preview surface whose colour, opacity and emitted light are textures.
fn painted() -> String {
    let material = r#"
def Material "Face"
{
    token outputs:surface.connect = </Face/Surface.outputs:surface>
    def Shader "Surface"
    {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </Face/Color.outputs:rgb>
        float inputs:opacity.connect = </Face/Color.outputs:a>
        float inputs:opacityThreshold = 1.5
        color3f inputs:emissiveColor.connect = </Face/Color.outputs:rgb>
        float inputs:roughness = 0.25
        token outputs:surface
    }
    def Shader "Color"
    {
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @maps/skin.png@
        token inputs:wrapS = "mirror"
        float2 inputs:st.connect = </Face/Place.outputs:result>
        float3 outputs:rgb
        float outputs:a
    }
    def Shader "Place"
    {
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }
}
"#;
    let of_mesh = "        texCoord2f[] primvars:st = [(0.25, 0.75), (0.5, 0), (1, 1)] (\n            interpolation = \"vertex\"\n        )\n        \
                   rel material:binding = </Face>\n";
    let at = STAGE.find("        int[] faceVertexCounts").expect("the mesh");
    format!("{}{of_mesh}{}{material}", &STAGE[..at], &STAGE[at..])
}

/// The painted figure in a package with its image.
fn packed() -> Vec<u8> {
    let image = package("maps/skin.png", &picture(ImageFormat::Png));
    [package("a.usda", painted().as_bytes()), image].concat()
}

#[test]
fn textures_of_preview_surfaces_are_found_beside_the_file_and_in_its_package() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("maps")).expect("a folder");
    std::fs::write(folder.path().join("maps/skin.png"), picture(ImageFormat::Png)).expect("an image");
    let stage = painted();
    for (bytes, folder) in [
        (stage.as_bytes().to_vec(), Some(folder.path())),
        (crate_of(&stage), Some(folder.path())),
        (packed(), None),
    ] {
        let character = load_character_bytes("a.usd", &bytes, folder).expect("a character");
        let body = &character.body;
        let [face] = &body.materials[..] else { panic!("{:?}", body.materials) };
        let base = face.base.expect("a texture");
        assert_eq!((base.image, base.wrap, face.roughness), (0, [Wrap::Mirror, Wrap::Repeat], 0.25));
        // A threshold above 1 hides the surface.
        assert_eq!((face.alpha, face.emissive_texture.map(|of| of.image)), (Alpha::Mask(1.5), Some(0)));
        assert_eq!((body.images.len(), body.images[0].size), (1, [4, 4]));
        let mut at = body.mesh.coordinates[0].clone();
        at.sort_by(|a, b| a.x.total_cmp(&b.x));
        assert_eq!(at, [Vec2::new(0.25, 0.25), Vec2::new(0.5, 1.0), Vec2::new(1.0, 0.0)]);
    }
    let missing = load_character_bytes("a.usda", stage.as_bytes(), None).expect("a character");
    assert!(missing.notes.iter().any(|note| note.contains("skin.png")), "{:?}", missing.notes);
}

/// A stage of one triangle, and another one with lines of its own and around it.
fn two_meshes(own: &str, above: &str) -> String {
    let mesh = |name: &str, lines: &str| {
        format!(
            "def Mesh \"{name}\"\n{{\nint[] faceVertexCounts = [3, 3]\nint[] faceVertexIndices = [0, 1, 2, 0, 2, 3]\n\
             point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]\n{lines}\n}}\n"
        )
    };
    format!(
        "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\n{}def Xform \"g\"\n{{\n{above}\n{}}}\n",
        mesh("a", ""),
        mesh("b", own)
    )
}

#[test]
fn hidden_meshes_are_left_out_counted_and_selectable() {
    let (invisible, guide) = ("token visibility = \"invisible\"", "uniform token purpose = \"guide\"");
    for (own, above, note) in [
        ("", "", ""),
        (invisible, "", "1 hidden mesh"),
        ("", invisible, "1 hidden mesh"),
        (guide, "", "1 guide or proxy mesh"),
        ("uniform token purpose = \"proxy\"", "", "1 guide or proxy mesh"),
        ("", guide, "1 guide or proxy mesh"),
        ("uniform token purpose = \"render\"", guide, ""),
        ("token visibility.timeSamples = { 0: \"invisible\", 5: \"inherited\" }", "", "1 hidden mesh"),
    ] {
        let text = two_meshes(own, above);
        let read = |include_hidden| {
            let settings = BodySettings { include_hidden, ..BodySettings::default() };
            load_character_bytes_with("a.usda", text.as_bytes(), None, settings).expect("a body").info()
        };
        let (shown, all) = (read(false), read(true));
        let drawn = if note.is_empty() { 4 } else { 2 };
        assert_eq!((shown.triangles, all.triangles), (drawn, 4), "{own} {above}");
        let noted = shown.notes.iter().any(|text| text.starts_with(&format!("left out {note}")));
        assert_eq!(noted, !note.is_empty(), "{own} {above}: {:?}", shown.notes);
    }
    // A body beside hidden curves is a body; all hidden is refused with the setting that helps.
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.usda");
    let curves = format!("def BasisCurves \"c\"\n{{\n{guide}\n}}\n");
    for (curves, wanted) in
        [(curves.clone(), FigureContent::Body), (curves.replace(guide, ""), FigureContent::Curves)]
    {
        std::fs::write(&path, two_meshes("", "") + &curves).expect("a file");
        assert_eq!(figure_content(&path).expect("USD"), Some(wanted));
        let body = load_character(&path).expect("a body");
        let what = if wanted == FigureContent::Body { "which the file hides" } else { "which are hair" };
        let note = format!("left out 1 prim of curves, {what}");
        assert!(body.notes.iter().any(|text| text.starts_with(&note)), "{:?}", body.notes);
    }
    let hidden = two_meshes("", "").replace("def Mesh \"a\"\n{", &format!("def Mesh \"a\"\n{{\n{invisible}"));
    let hidden = hidden.replace("def Xform \"g\"\n{", &format!("def Xform \"g\"\n{{\n{invisible}"));
    let error = load_character_bytes("a.usda", hidden.as_bytes(), None).expect_err("nothing").to_string();
    assert!(error.contains("2 hidden meshes") && error.contains("*Include hidden*"), "{error}");
}

#[test]
fn display_colours_have_the_interpolation_that_they_state() {
    let (r, g, b) = (Vec3::X, Vec3::Y, Vec3::Z);
    // The colours of the second mesh at its corners, face after face.
    for (said, values, wanted) in [
        ("constant", "(1, 0, 0)", [r; 6]),
        ("uniform", "(1, 0, 0), (0, 1, 0)", [r, r, r, g, g, g]),
        ("vertex", "(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)", [r, g, b, r, b, r]),
        ("varying", "(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)", [r, g, b, r, b, r]),
        (
            "faceVarying",
            "(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 1, 0), (0, 0, 1), (1, 0, 0)",
            [r, g, b, g, b, r],
        ),
    ] {
        let own = format!("color3f[] primvars:displayColor = [{values}] (\n interpolation = \"{said}\"\n)");
        let indexed = "color3f[] primvars:displayColor = [(0, 0, 1), (0, 1, 0), (1, 0, 0)] (\n interpolation = \"uniform\"\n)\n\
                       int[] primvars:displayColor:indices = [2, 1]";
        let inherited = "color3f[] primvars:displayColor = [(1, 0, 0)]";
        for (own, above, wanted) in [
            (own.as_str(), "", wanted),
            (indexed, "", [r, r, r, g, g, g]),
            ("", inherited, [r; 6]),
            (own.as_str(), "color3f[] primvars:displayColor = [(1, 1, 1)]", wanted),
        ] {
            let text = two_meshes(own, above);
            let body = load_character_bytes("a.usda", text.as_bytes(), None).expect("a body").body;
            let colors: Vec<Vec3> = body.mesh.triangles[2..]
                .as_flattened()
                .iter()
                .map(|&v| body.mesh.colors[v as usize])
                .collect();
            assert_eq!(colors, wanted, "{said}: {text}");
        }
    }
}
