//! All real and all broken characters: what is read of them, or why they are refused.

use crate::common;

use std::path::Path;

use glam::Vec3;
use lovelock_motion::{
    BodySettings, Character, GltfError, LengthUnit, MotionError, Pose, Skin, UpAxis, joint_paths,
    load_character, load_character_bytes, load_character_with, pose_at, skin,
};

/// Expected content of a file: joints, skins, vertices, triangles, clips, morph targets, head, height in
/// metres.
type Row = (&'static str, usize, usize, usize, usize, usize, usize, &'static str, f32);

/// See [`Row`]; counted with another program.
const GOOD: [Row; 10] = [
    ("CesiumMan.glb", 19, 1, 3273, 4672, 1, 0, "node 20", 1.51),
    ("CesiumMan_quantized.glb", 19, 1, 3273, 4672, 1, 0, "node 20", 1.51),
    ("Fox.glb", 24, 1, 1728, 576, 3, 0, "b_Head_05", 0.79),
    ("Fox_cubicspline_step.glb", 24, 1, 1728, 576, 5, 0, "b_Head_05", 0.79),
    ("MorphStressTest.gltf", 1, 0, 1528, 2412, 3, 8, "Main", 0.6),
    ("MorphStress_sparse.glb", 1, 0, 1528, 2412, 3, 8, "Main", 0.6),
    ("SimpleSkin.gltf", 2, 1, 10, 8, 1, 0, "node 2", 2.0),
    ("mh_body.glb", 163, 1, 13380, 26756, 0, 0, "head", 1.67),
    ("robot.glb", 43, 1, 7218, 3238, 14, 0, "Head", 4.56),
    ("broken/quad_skin.glb", 10, 1, 4, 2, 0, 0, "Bone.000", 0.0),
];

#[test]
fn real_characters_load_completely() {
    let Some(data) = common::data_dir() else { return };
    for (file, joints, skins, vertices, triangles, clips, morphs, head, height) in GOOD {
        let character = load_character(&data.join("characters").join(file)).unwrap_or_else(|e| panic!("{e}"));
        let info = character.info();
        println!("{file}: {info:?}");
        let counts =
            (info.joints, info.skins, info.vertices, info.triangles, info.clips.len(), info.morph_targets);
        assert_eq!(counts, (joints, skins, vertices, triangles, clips, morphs), "{file}");
        assert_eq!(info.head, head, "{file}");
        assert!((info.height_m - height).abs() < 0.01 * height + 0.005, "{file}: {}", info.height_m);
        check_invariants(file, &character);
    }
}

/// Invariants of every body: unit normals, weights that sum to 1, parents first, and a rest pose that
/// skinning reproduces.
fn check_invariants(file: &str, character: &Character) {
    let body = &character.body;
    let mesh = &body.mesh;
    assert_eq!(mesh.positions.len(), mesh.joints.len(), "{file}");
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3), "{file}");
    assert!(mesh.weights.iter().all(|w| (w.iter().sum::<f32>() - 1.0).abs() < 1e-4), "{file}");
    assert!(
        body.skeleton.joints.iter().enumerate().all(|(j, joint)| joint.parent.is_none_or(|p| p < j)),
        "{file}"
    );
    let (mut pose, mut rest) = (Pose::default(), Skin::default());
    pose_at(body, None, 0.0, &mut pose);
    skin(body, &pose, &mut rest);
    assert_eq!(rest.positions, mesh.positions, "{file}");
    let head = body.skeleton.rest_position(body.head_joint);
    assert!(pose.world_from_head.abs_diff_eq(glam::Affine3A::from_translation(head), 1e-4), "{file}");
    let paths = joint_paths(&body.skeleton);
    let distinct: std::collections::BTreeSet<_> = paths.iter().collect();
    assert_eq!(distinct.len(), body.skeleton.joints.len(), "{file}");
    // Every clip at several times, also far outside its range: finite, near the body, and rigid at the head.
    for clip in &character.clips {
        for k in -3..8 {
            pose_at(body, Some(clip), f64::from(k) * 0.37, &mut pose);
            skin(body, &pose, &mut rest);
            assert!(rest.positions.iter().all(|p| p.length() < 20.0), "{file} {}", clip.name);
            let turn = pose.world_from_head.matrix3;
            assert!(
                (turn * turn.transpose()).abs_diff_eq(glam::Mat3A::IDENTITY, 1e-4),
                "{file} {}",
                clip.name
            );
        }
    }
}

#[test]
fn errors_contain_file_and_problem() {
    let Some(data) = common::data_dir() else { return };
    for (file, words) in [
        ("CesiumMan_draco.glb", "KHR_draco_mesh_compression"),
        ("Fox_meshopt.glb", "EXT_meshopt_compression"),
        ("broken/BoxTextured.gltf", "BoxTextured0.bin"),
        ("broken/IndexOutOfRange.gltf", "IndexOutOfRange.bin"),
        ("broken/RecursiveNodes.gltf", "without a usable triangle"),
        ("broken/badArray.gltf", "line 44"),
        ("nowhere.glb", "cannot be read"),
    ] {
        let error = load_character(&data.join("characters").join(file)).expect_err(file).to_string();
        println!("{error}");
        assert!(error.contains(words) && error.contains(file) && error.lines().count() == 1, "{error}");
    }
}

#[test]
fn infinite_positions_are_dropped_and_counted() {
    let Some(data) = common::data_dir() else { return };
    match load_character(&data.join("characters/broken/BoxWithInfinites.glb")) {
        Ok(character) => {
            assert!(character.dropped["vertices"] > 0);
            check_invariants("BoxWithInfinites.glb", &character);
        }
        Err(e) => assert!(matches!(e, MotionError::Empty { .. }), "{e}"),
    }
}

/// Largest distance between two bodies' skins over a clip, as a fraction of the height.
fn difference(a: &Character, b: &Character) -> f32 {
    let (mut pose, mut skin_a, mut skin_b) = (Pose::default(), Skin::default(), Skin::default());
    let mut worst = 0.0_f32;
    for k in 0..9 {
        let time = f64::from(k) * 0.21;
        pose_at(&a.body, a.clips.first().map(|c| &**c), time, &mut pose);
        skin(&a.body, &pose, &mut skin_a);
        pose_at(&b.body, b.clips.first().map(|c| &**c), time, &mut pose);
        skin(&b.body, &pose, &mut skin_b);
        for (p, q) in skin_a.positions.iter().zip(&skin_b.positions) {
            worst = worst.max(p.distance(*q));
        }
    }
    worst / a.body.height()
}

#[test]
fn quantised_meshes_equal_plain_ones() {
    let Some(data) = common::data_dir() else { return };
    let load = |file: &str| load_character(&data.join("characters").join(file)).unwrap();
    let (plain, quantised) = (load("CesiumMan.glb"), load("CesiumMan_quantized.glb"));
    // Positions keep 14 bits (6e-5) and weights 8 bits: 1/255 of a weight across a limb of a tenth of the
    // height.
    let worst = difference(&plain, &quantised);
    println!("{worst}");
    assert!(worst < 2e-3, "{worst}");
    // Negative control: half of the animation differs far more.
    let mut late = plain.clone();
    let mut clip = (*late.clips[0]).clone();
    clip.joints.truncate(3);
    late.clips[0] = clip.into();
    assert!(difference(&late, &quantised) > 0.05);
}

#[test]
fn sparse_accessors_equal_dense_ones() {
    let Some(data) = common::data_dir() else { return };
    let load = |file: &str| load_character(&data.join("characters").join(file)).unwrap();
    let (dense, sparse) = (load("MorphStressTest.gltf"), load("MorphStress_sparse.glb"));
    assert_eq!(dense.body.mesh.positions, sparse.body.mesh.positions);
    assert_eq!(dense.body.skin.morphs, sparse.body.skin.morphs);
    assert!(difference(&dense, &sparse) == 0.0);
    // The targets do move something.
    assert!(dense.body.skin.morphs.iter().all(|m| m.positions.iter().any(|d| d.length() > 0.01)));
}

#[test]
fn unit_and_axis_can_be_chosen() {
    let Some(data) = common::data_dir() else { return };
    let path = data.join("characters/Fox.glb");
    let auto = load_character(&path).unwrap();
    let settings = BodySettings { unit: LengthUnit::Metres, ..BodySettings::default() };
    let metres = load_character_with(&path, settings).unwrap();
    assert!((metres.body.height() / auto.body.height() - 100.0).abs() < 0.01);
    assert!(difference(&auto, &auto) == 0.0);
    let turned =
        load_character_with(&path, BodySettings { up: UpAxis::Z, ..BodySettings::default() }).unwrap();
    let (p, q) = (auto.body.mesh.positions[100], turned.body.mesh.positions[100]);
    assert!(q.distance(Vec3::new(p.x, p.z, -p.y)) < 1e-5, "{p} {q}");
    check_invariants("Fox turned", &turned);
}

#[test]
fn files_outside_the_folder_are_refused() {
    let text = br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"../secret.bin"}]}"#;
    let error = load_character_bytes("x.gltf", text, Some(Path::new("."))).unwrap_err();
    let MotionError::Gltf(GltfError::Outside { uri, .. }) = &error else { panic!("{error}") };
    assert_eq!(uri, "../secret.bin");
}

#[test]
fn counts_are_checked_before_allocation() {
    // Four billion vertices without bytes, and in a view of four bytes.
    for view in ["", r#""bufferView":0,"#] {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{{view}"componentType":5126,"count":18446744073709551615,"type":"VEC3"}}],
            "bufferViews":[{{"buffer":0,"byteLength":4}}],
            "buffers":[{{"byteLength":4,"uri":"data:application/octet-stream;base64,AAAAAA=="}}]}}"#
        );
        let error = load_character_bytes("x.gltf", text.as_bytes(), None).unwrap_err();
        assert!(error.to_string().contains("accessor 0"), "{error}");
    }
}

#[test]
fn triangles_of_every_primitive_name_their_own_vertices() {
    // Two triangles of their own vertices, one above the other, as two primitives with the same indices.
    let floats = |values: [f32; 9]| values.into_iter().flat_map(f32::to_le_bytes).collect::<Vec<u8>>();
    let mut bytes = floats([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0]);
    bytes.extend(floats([0.0, 2.0, 0.0, 1.0, 2.0, 0.0, 0.0, 2.0, -1.0]));
    let file = std::env::temp_dir().join(format!("lovelock-primitives-{}", std::process::id()));
    std::fs::create_dir_all(&file).expect("a folder");
    std::fs::write(file.join("a.bin"), &bytes).expect("written");
    let text = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}},{"attributes":{"POSITION":1}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
            {"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":72}],"buffers":[{"byteLength":72,"uri":"a.bin"}]}"#;
    let body = load_character_bytes("x.gltf", text.as_bytes(), Some(&file)).expect("two triangles").body;
    std::fs::remove_dir_all(&file).expect("removed");
    let heights: Vec<f32> =
        body.mesh.triangles.iter().map(|t| body.mesh.positions[t[2] as usize].y).collect();
    assert_eq!(heights, [0.0, 2.0]);
}

#[test]
fn meshes_of_nodes_that_are_not_visible_are_left_out_counted_and_selectable() {
    let mut buffer = Vec::new();
    for value in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        buffer.extend(value.to_le_bytes());
    }
    // Visibility of the parent and of the node with the second mesh.
    for (parent, own, is_drawn) in
        [(true, true, true), (false, true, false), (true, false, false), (false, false, false)]
    {
        let visibility = |visible: bool| {
            format!("\"extensions\": {{ \"KHR_node_visibility\": {{ \"visible\": {visible} }} }}")
        };
        let document = format!(
            "{{ \"asset\": {{ \"version\": \"2.0\" }}, \"scenes\": [{{ \"nodes\": [0, 1] }}], \"nodes\": [\
             {{ \"mesh\": 0 }}, {{ \"children\": [2], {} }}, {{ \"mesh\": 0, {} }}],\
             \"meshes\": [{{ \"primitives\": [{{ \"attributes\": {{ \"POSITION\": 0 }} }}] }}],\
             \"accessors\": [{{ \"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\" }}],\
             \"bufferViews\": [{{ \"buffer\": 0, \"byteLength\": 36 }}], \"buffers\": [{{ \"byteLength\": 36 }}] }}",
            visibility(parent),
            visibility(own)
        );
        let bytes = common::glb(document, buffer.clone());
        let read = |include_hidden| {
            let settings = BodySettings { include_hidden, ..BodySettings::default() };
            lovelock_motion::load_character_bytes_with("a.glb", &bytes, None, settings)
                .expect("a body")
                .info()
        };
        let (shown, all) = (read(false), read(true));
        assert_eq!((shown.triangles, all.triangles), (if is_drawn { 2 } else { 1 }, 2), "{parent} {own}");
        let noted = shown.notes.iter().any(|note| note.starts_with("left out 1 hidden mesh"));
        assert_eq!(noted, !is_drawn, "{:?}", shown.notes);
    }
}
