//! VRM: the bones that a file names, its face, its own hair, and motion of the format.

use crate::common;

use glam::Vec3;
use lovelock_motion::{
    BodySettings, MotionSettings, OwnHair, load_character_bytes, load_character_bytes_with, load_motion_bytes,
};
use lovelock_testkit::fuzz::damaged;

/// Version of a file, or a motion.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Zero,
    One,
    Motion,
}

/// A figure whose names say nothing: `n0` the hips at 1 m, `n1` the spine, `n2` the head, `n3` a joint of swinging hair on it, `n4` and
/// `n5` the thighs. One triangle follows the head, another the hair. The hips turn in the only clip. In VRM 0.x everything is turned by
/// half a turn, because its figures face -Z.
fn file(kind: Kind, spring: &str) -> Vec<u8> {
    let turn = if kind == Kind::Zero { -1.0 } else { 1.0 };
    let mut bin: Vec<u8> = Vec::new();
    let mut floats = |values: &[f32]| bin.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    floats(&[0.1 * turn, 1.5, 0.0, 0.0, 1.5, 0.1 * turn, 0.0, 1.6, 0.0]);
    floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    floats(&[0.0, 1.0]);
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.5_f32.sqrt(), 0.0, 0.5_f32.sqrt()]);
    for y in [-1.5_f32, -1.6] {
        floats(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, y, 0.0, 1.0]);
    }
    bin.extend([0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    bin.extend([1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    let bones = [("hips", 0), ("spine", 1), ("head", 2), ("leftUpperLeg", 4), ("rightUpperLeg", 5)];
    let of_1 = bones.map(|(bone, node)| format!(r#""{bone}":{{"node":{node}}}"#)).join(",");
    let of_0 = bones.map(|(bone, node)| format!(r#"{{"bone":"{bone}","node":{node}}}"#)).join(",");
    let extensions = match kind {
        Kind::One => format!(
            r#""VRMC_vrm":{{"humanoid":{{"humanBones":{{{of_1}}}}}}},
            "VRMC_springBone":{{"springs":[{{"name":"{spring}","joints":[{{"node":3}}]}}]}}"#
        ),
        Kind::Zero => format!(
            r#""VRM":{{"humanoid":{{"humanBones":[{of_0}]}},"secondaryAnimation":{{"boneGroups":[{{"comment":"{spring}","bones":[3]}}]}}}}"#
        ),
        Kind::Motion => format!(r#""VRMC_vrm_animation":{{"humanoid":{{"humanBones":{{{of_1}}}}}}}"#),
    };
    let (meshes, instances) = if kind == Kind::Motion {
        (String::new(), String::new())
    } else {
        let mesh = |joints: u32| {
            format!(
                r#"{{"primitives":[{{"attributes":{{"POSITION":0,"WEIGHTS_0":1,"JOINTS_0":{joints}}}}}]}}"#
            )
        };
        let meshes = format!(
            r#""meshes":[{},{}],"skins":[{{"joints":[2,3],"inverseBindMatrices":4}}],"#,
            mesh(5),
            mesh(6)
        );
        (meshes, r#",{"name":"m0","mesh":0,"skin":0},{"name":"m1","mesh":1,"skin":0}"#.to_owned())
    };
    let roots = if kind == Kind::Motion { "0" } else { "0,6,7" };
    let (left, right) = (0.1 * turn, -0.1 * turn);
    let length = bin.len();
    let view = |offset: u32, count: u32, kind: &str| {
        format!(
            r#"{{"bufferView":0,"byteOffset":{offset},"componentType":5126,"count":{count},"type":"{kind}"}}"#
        )
    };
    let small = |offset: u32| {
        format!(r#"{{"bufferView":0,"byteOffset":{offset},"componentType":5121,"count":3,"type":"VEC4"}}"#)
    };
    let accessors = [
        view(0, 3, "VEC3"),
        view(36, 3, "VEC4"),
        view(84, 2, "SCALAR"),
        view(92, 2, "VEC4"),
        view(124, 2, "MAT4"),
        small(252),
        small(264),
    ]
    .join(",");
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"extensions":{{{extensions}}},"scene":0,"scenes":[{{"nodes":[{roots}]}}],
        "nodes":[{{"name":"n0","translation":[0,1,0],"children":[1,4,5]}},{{"name":"n1","translation":[0,0.25,0],"children":[2]}},
        {{"name":"n2","translation":[0,0.25,0],"children":[3]}},{{"name":"n3","translation":[0,0.1,0]}},
        {{"name":"n4","translation":[{left},0,0]}},{{"name":"n5","translation":[{right},0,0]}}{instances}],{meshes}
        "animations":[{{"name":"turn","samplers":[{{"input":2,"output":3}}],"channels":[{{"sampler":0,"target":{{"node":0,"path":"rotation"}}}}]}}],
        "accessors":[{accessors}],"bufferViews":[{{"buffer":0,"byteLength":{length}}}],"buffers":[{{"byteLength":{length}}}]}}"#
    );
    common::glb(json, bin)
}

#[test]
fn the_bones_of_the_file_replace_guesses() {
    for (kind, format) in [(Kind::One, "VRM 1.0"), (Kind::Zero, "VRM 0.x")] {
        let character = load_character_bytes("a.vrm", &file(kind, "Hair"), None).expect("a character");
        let info = character.info();
        assert!(info.format.starts_with(format), "{}", info.format);
        assert_eq!((info.head.as_str(), info.vertices), ("n2", 3));
        assert!(info.notes.iter().any(|note| note.contains("`m1`")), "{:?}", info.notes);
        // Both face +Z, with the left toward +X.
        let found = &character.body.mesh.positions;
        for expected in [Vec3::new(0.1, 1.5, 0.0), Vec3::new(0.0, 1.5, 0.1), Vec3::new(0.0, 1.6, 0.0)] {
            assert!(found.iter().any(|p| p.distance(expected) < 1e-5), "{found:?}");
        }
        let named = &character.body.skeleton.named;
        let left = named.iter().find(|(_, bone)| *bone == "leftUpperLeg").expect("a thigh");
        assert!(character.body.skeleton.rest_position(*left.0).x > 0.05);
    }
}

#[test]
fn hair_of_the_model_is_hidden_unless_it_shall_be_shown() {
    for kind in [Kind::One, Kind::Zero] {
        // A spring without a telling name is hair if none says so and it hangs on the head.
        for spring in ["Hair", "group 1"] {
            let bytes = file(kind, spring);
            let hidden = load_character_bytes("a.vrm", &bytes, None).expect("a character");
            assert_eq!(hidden.body.mesh.positions.len(), 3, "{spring}");
            let settings = BodySettings { own_hair: OwnHair::Shown, ..BodySettings::default() };
            let shown = load_character_bytes_with("a.vrm", &bytes, None, settings).expect("a character");
            assert_eq!(shown.body.mesh.positions.len(), 6, "{spring}");
        }
    }
}

#[test]
fn motion_of_vrm_names_its_joints() {
    let bytes = file(Kind::Motion, "");
    let error = load_character_bytes("a.vrma", &bytes, None).expect_err("no body").to_string();
    assert!(error.contains("Motion file"), "{error}");
    let motion = load_motion_bytes("a.vrma", &bytes, MotionSettings::default()).expect("a motion");
    assert!(motion.format.starts_with("VRM animation 1.0"), "{}", motion.format);
    let names: Vec<&str> = motion.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["hips", "spine", "head", "", "leftUpperLeg", "rightUpperLeg"]);
    assert_eq!((motion.frames, motion.clips.len()), (61, 1));
}

#[test]
fn wrong_extensions_leave_a_gltf() {
    let bytes = file(Kind::One, "Hair");
    for (from, to) in [
        (r#""humanBones":{"hips":{"node":0}"#, r#""humanBones":{"hips":{"node":9}"#),
        (r#""humanBones":{"#, r#""HumanBones":{"#),
        (r#""joints":[{"node":3}]"#, r#""joints":[{"node":8}]"#),
    ] {
        // The lengths stay, so that the container does.
        assert_eq!(from.len(), to.len());
        let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).expect(from);
        let mut changed = bytes.clone();
        changed[at..at + to.len()].copy_from_slice(to.as_bytes());
        let character = load_character_bytes("a.vrm", &changed, None).expect("a character");
        assert!(character.body.mesh.positions.len() >= 3);
    }
}

#[test]
fn damaged_character_vrm() {
    damaged("vrm", &[file(Kind::One, "Hair"), file(Kind::Zero, "Hair")], 3000, |bytes| {
        common::reads_character("a.vrm", bytes)
    });
}

#[test]
fn damaged_motion_vrma() {
    damaged("vrma", &[file(Kind::Motion, "")], 2000, |bytes| {
        common::reads_motion("a.vrma", bytes, MotionSettings::default())
    });
}
