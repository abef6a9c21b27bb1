//! FBX: known positions in every unit and axis, motion alone, and files that are refused.

use glam::{Vec2, Vec3};
use image::ImageFormat;
use lovelock_motion::{
    Character, FigureContent, MotionSettings, Region, Wrap, figure_content, load_character_bytes,
    load_motion_bytes,
};
use lovelock_testkit::fuzz::damaged;

use crate::common::fbx::{Cap, Node, Space, Value, binary, figure, text, with_cap, with_texture};
use crate::common::{assert_near, points_at, reads_character, textured::picture};

const SPACES: [Space; 4] = [
    Space { z_up: false, unit: 1.0 },
    Space { z_up: true, unit: 1.0 },
    Space { z_up: false, unit: 100.0 },
    Space { z_up: true, unit: 2.54 },
];

fn load(bytes: &[u8]) -> Character {
    load_character_bytes("figure.fbx", bytes, None).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_figure_is_the_same_in_every_unit_and_axis() {
    for space in SPACES {
        let nodes = figure(space);
        for bytes in [text(&nodes).into_bytes(), binary(&nodes)] {
            let character = load(&bytes);
            let info = character.info();
            assert_eq!((info.joints, info.skins, info.vertices, info.morph_targets), (2, 1, 3, 1));
            assert_eq!((info.head.as_str(), info.clips.len()), ("head", 1));
            assert!((info.height_m - 0.1).abs() < 1e-6, "{}", info.height_m);
            assert!((info.clips[0].duration_secs - 1.0).abs() < 1e-6 && info.clips[0].name == "dance");
            let head = character.body.skeleton.rest_position(character.body.head_joint);
            assert!(head.distance(Vec3::new(0.0, 1.5, 0.0)) < 1e-5, "{head}");
            let (left, front) = (Vec3::new(0.1, 1.5, 0.0), Vec3::new(0.0, 1.5, 0.1));
            assert_near(&points_at(&character, 0.0), [left, front, Vec3::new(0.0, 1.6, 0.0)]);
            // A quarter turn to the left carries the left to the back, and the front to the left.
            let back = Vec3::new(0.0, 1.5, -0.1);
            assert_near(&points_at(&character, 1.0_f64.next_down()), [back, left, Vec3::new(0.0, 1.7, 0.0)]);
            let half = std::f32::consts::FRAC_1_SQRT_2 * 0.1;
            let (a, b) = (Vec3::new(half, 1.5, -half), Vec3::new(half, 1.5, half));
            assert_near(&points_at(&character, 0.5), [a, b, Vec3::new(0.0, 1.65, 0.0)]);
        }
    }
}

#[test]
fn a_unit_that_the_user_sets_overrules_that_of_the_file() {
    let bytes = binary(&figure(SPACES[0]));
    let settings =
        lovelock_motion::BodySettings { unit: lovelock_motion::LengthUnit::Decimetres, ..Default::default() };
    let character = lovelock_motion::load_character_bytes_with("f.fbx", &bytes, None, settings).expect("it");
    assert!((character.body.height() - 1.0).abs() < 1e-5);
    assert!((character.unit_metres - 0.1).abs() < 1e-6);
}

#[test]
fn a_clip_without_a_body_is_a_motion_and_no_character() {
    let mut nodes = figure(SPACES[1]);
    for node in &mut nodes {
        let is_body = |node: &Node| {
            ["Geometry", "Deformer"].contains(&node.name)
                || node.values.iter().any(|v| matches!(v, Value::Text("body", _)))
        };
        node.children.retain(|node| !is_body(node));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let content = |nodes: &[Node]| {
        let path = folder.path().join("a.fbx");
        std::fs::write(&path, binary(nodes)).expect("a file");
        figure_content(&path).expect("FBX")
    };
    assert_eq!(content(&figure(SPACES[1])), Some(FigureContent::Body));
    assert_eq!(content(&nodes), Some(FigureContent::Clip));
    let bytes = binary(&nodes);
    let error = load_character_bytes("clip.fbx", &bytes, None).expect_err("no body").to_string();
    assert!(error.starts_with("clip.fbx: contains") && error.contains("Motion file"), "{error}");
    let motion = load_motion_bytes("clip.fbx", &bytes, MotionSettings::default()).expect("a motion");
    let names: Vec<&str> = motion.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!((names, motion.frames), (vec!["hips", "head"], 61));
    assert_eq!(motion.clips, ["dance"]);
    let rest = motion.rest();
    assert!(rest[1].distance(Vec3::new(0.0, 1.5, 0.0)) < 1e-5, "{rest:?}");
    // Relative to rest the hips turn to the left, and the head goes with them.
    let mut world = Vec::new();
    motion.world(60, &mut world);
    for joint in &world {
        let forward = joint.transform_vector3(Vec3::Z);
        assert!(forward.distance(Vec3::X) < 1e-4, "{forward}");
    }
    for node in &mut nodes {
        node.children.retain(|node| !node.name.starts_with("Animation"));
    }
    assert_eq!(content(&nodes), Some(FigureContent::Nothing));
}

#[test]
fn refusals_are_sentences() {
    let whole = binary(&figure(SPACES[0]));
    let refused = |bytes: &[u8]| load_character_bytes("x.fbx", bytes, None).expect_err("refused").to_string();
    for (bytes, says) in [
        (&[][..], "is empty"),
        (&whole[..20], "x.fbx: the file: "),
        (&whole[..200], "cut off"),
        (&whole[..whole.len() / 2], "cut off"),
        (&b"; FBX 7.4.0 project file\n"[..], "x.fbx: the file: "),
        (&b"; FBX 7.4.0 project file\nObjects: {\n"[..], "x.fbx"),
    ] {
        let error = refused(bytes);
        assert!(error.contains(says) && !error.contains('\n'), "{error}");
    }
    let mut encrypted = figure(SPACES[0]);
    encrypted.truncate(1);
    encrypted[0].children[2].values = vec![Value::Integer(1)];
    for bytes in [text(&encrypted).into_bytes(), binary(&encrypted)] {
        let error = refused(&bytes);
        assert!(error.contains("an encrypted document"), "{error}");
    }
}

#[test]
fn joints_in_a_circle_and_of_no_size_are_survived() {
    let mut nodes = figure(SPACES[0]);
    // The hips become a child of the head, which is their child.
    for link in &mut nodes[3].children {
        if matches!(link.values[..], [_, Value::Integer(21), Value::Integer(0)]) {
            link.values[2] = Value::Integer(22);
        }
    }
    let _ = load_character_bytes("circle.fbx", &binary(&nodes), None);

    let mut nodes = figure(SPACES[0]);
    for model in nodes[2].children.iter_mut().filter(|node| node.name == "Model") {
        if let Some(properties) = model.children.get_mut(1) {
            let name = Value::Text("Lcl Scaling", "");
            let zero = || Value::Number(0.0);
            let values =
                vec![name, Value::Text("Lcl Scaling", ""), Value::Text("", ""), Value::Text("A", "")];
            let values = values.into_iter().chain([zero(), zero(), zero()]).collect();
            properties.children.push(Node { name: "P", values, children: vec![] });
        }
    }
    let character = load(&binary(&nodes));
    assert!(points_at(&character, 0.5).iter().all(|p| p.is_finite()));
}

fn survives(bytes: &[u8]) -> bool {
    let _ = load_motion_bytes("x.fbx", bytes, MotionSettings::default());
    reads_character("x.fbx", bytes)
}

#[test]
fn files_cut_anywhere_are_survived() {
    let nodes = figure(SPACES[1]);
    for bytes in [text(&nodes).into_bytes(), binary(&nodes)] {
        for end in (0..bytes.len()).step_by(7) {
            survives(&bytes[..end]);
        }
    }
}

#[test]
fn damaged_character_fbx() {
    let nodes = figure(SPACES[1]);
    let painted = with_texture(figure(SPACES[0]), Some(&picture(ImageFormat::Png)));
    let files = [text(&nodes).into_bytes(), binary(&nodes), binary(&painted)];
    damaged("fbx", &files, 2000, survives);
}

#[test]
fn textures_are_in_the_file_or_beside_it_whatever_their_path_was() {
    let png = picture(ImageFormat::Png);
    let folder = tempfile::tempdir().expect("a folder");
    let load = |nodes: &[Node], is_text: bool| {
        let bytes = if is_text { text(nodes).into_bytes() } else { binary(nodes) };
        load_character_bytes("figure.fbx", &bytes, Some(folder.path()))
            .unwrap_or_else(|error| panic!("{error}"))
    };
    let check = |character: &Character, what: &str| {
        let body = &character.body;
        assert!(character.notes.iter().all(|note| !note.contains("image")), "{what}: {:?}", character.notes);
        let [face] = &body.materials[..] else { panic!("{what}: {:?}", body.materials) };
        assert_eq!((face.name.as_str(), face.region), ("Face", Region::Skin), "{what}");
        let base = face.base.unwrap_or_else(|| panic!("{what}: no texture"));
        assert_eq!((base.image, base.set, base.wrap), (0, 0, [Wrap::Clamp, Wrap::Repeat]), "{what}");
        assert_eq!((body.images[0].name.as_str(), body.images[0].size), ("skin.png", [4, 4]), "{what}");
        assert_eq!(body.images[0].pixels[..8], [250, 0, 30, 255, 250, 0, 30, 245], "{what}");
        // Rows of images count from above.
        let mut at = body.mesh.coordinates[0].clone();
        at.sort_by(|a, b| a.x.total_cmp(&b.x));
        assert_eq!(at, [Vec2::new(0.25, 0.25), Vec2::new(0.5, 1.0), Vec2::new(1.0, 0.0)], "{what}");
        // The texture stands in the place of the colour.
        assert!(body.mesh.colors.iter().all(|color| *color == Vec3::ONE), "{what}: {:?}", body.mesh.colors);
    };
    check(&load(&with_texture(figure(SPACES[0]), Some(&png)), false), "in the file");
    let outside = with_texture(figure(SPACES[0]), None);
    let missing = load(&outside, false);
    assert!(missing.notes.iter().any(|note| note.contains("`skin.png`")), "{:?}", missing.notes);
    // The colour is seen where the image is missing.
    assert!(
        missing.body.mesh.colors[0].abs_diff_eq(Vec3::new(0.1, 0.2, 0.3), 1e-6),
        "{:?}",
        missing.body.mesh.colors
    );
    std::fs::create_dir(folder.path().join("textures")).expect("a folder");
    std::fs::write(folder.path().join("textures/skin.png"), &png).expect("an image");
    for is_text in [false, true] {
        check(&load(&outside, is_text), "beside the file");
    }
}

#[test]
fn hidden_meshes_are_left_out_counted_and_selectable() {
    const INHERITS: &str = "Visibility Inheritance";
    let off = |name: &'static str| vec![(name, if name == "Show" { "bool" } else { name }, 0)];
    let plain = Cap::default;
    for (what, cap, is_drawn) in [
        ("nothing", plain(), true),
        ("own visibility", Cap { own: off("Visibility"), ..plain() }, false),
        ("own show", Cap { own: off("Show"), ..plain() }, false),
        ("visibility of the group", Cap { group: off("Visibility"), ..plain() }, false),
        ("no inheritance", Cap { group: off("Visibility"), own: off(INHERITS), ..plain() }, true),
        ("a layer that is off", Cap { layer: Some(0), ..plain() }, false),
        ("a layer that is on", Cap { layer: Some(1), ..plain() }, true),
        ("hidden at first", Cap { animated: Some([0.0, 1.0]), ..plain() }, false),
        ("shown at first", Cap { animated: Some([1.0, 0.0]), own: off("Visibility"), ..plain() }, true),
        ("a coarser level", Cap { is_level: true, ..plain() }, false),
    ] {
        let nodes = with_cap(figure(SPACES[0]), &cap);
        for bytes in [text(&nodes).into_bytes(), binary(&nodes)] {
            let read = |include_hidden| {
                let settings = lovelock_motion::BodySettings { include_hidden, ..Default::default() };
                let character = lovelock_motion::load_character_bytes_with("f.fbx", &bytes, None, settings);
                character.unwrap_or_else(|error| panic!("{what}: {error}")).info()
            };
            let (shown, all) = (read(false), read(true));
            assert_eq!((shown.triangles, all.triangles), (if is_drawn { 2 } else { 1 }, 2), "{what}");
            let noted = |notes: &[String], start: &str| notes.iter().any(|note| note.starts_with(start));
            assert_eq!(noted(&shown.notes, "left out 1"), !is_drawn, "{what}: {:?}", shown.notes);
            assert_eq!(noted(&all.notes, "includes 1"), !is_drawn, "{what}: {:?}", all.notes);
        }
    }
}
