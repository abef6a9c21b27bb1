//! Expressions of VRM files, faces of VRM animations, and morph targets that do not fit.

use crate::common;

use lovelock_motion::{
    Character, Face, FaceWeights, MotionSettings, Pose, load_character_bytes, load_motion_bytes, pose_at,
};

/// A triangle with two morph targets, of which `targets` says the second; `more` are further members of the document.
fn figure(targets: &str, more: &str) -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let mut floats = |values: &[f32]| bin.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    floats(&[0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    floats(&[0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 7.0, 0.0]);
    let length = bin.len();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,1]}}],"nodes":[{{"name":"n","mesh":0}},{{"name":"face"}}],
        "meshes":[{{"extras":{{"targetNames":["lids","lips"]}},"primitives":[{{"attributes":{{"POSITION":0}},
        "targets":[{{"POSITION":1}},{{"POSITION":{targets}}}]}}]}}],
        "animations":[{{"name":"a","samplers":[{{"input":3,"output":4}}],"channels":[{{"sampler":0,"target":{{"node":1,"path":"translation"}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
        {{"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC3"}},
        {{"bufferView":0,"byteOffset":36,"componentType":5126,"count":2,"type":"VEC3"}},
        {{"bufferView":0,"byteOffset":72,"componentType":5126,"count":2,"type":"SCALAR"}},
        {{"bufferView":0,"byteOffset":80,"componentType":5126,"count":2,"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{length}}}],"buffers":[{{"byteLength":{length}}}]{more}}}"#
    );
    common::glb(json, bin)
}

fn read(targets: &str, more: &str) -> Character {
    load_character_bytes("x.vrm", &figure(targets, more), None).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn expressions_of_both_versions_of_vrm_move_the_same() {
    let one = r#","extensions":{"VRMC_vrm":{"expressions":{"preset":{"blink":{"morphTargetBinds":[{"node":0,"index":0,"weight":0.5},
        {"node":0,"index":1,"weight":0.25},{"node":0,"index":9,"weight":1},{"node":77,"index":0,"weight":1}]}},"custom":{"wide":{"isBinary":true,"morphTargetBinds":
        [{"node":0,"index":1,"weight":1}]}}}}}"#;
    let zero = r#","extensions":{"VRM":{"blendShapeMaster":{"blendShapeGroups":[{"name":"Blink","presetName":"blink","binds":
        [{"mesh":0,"index":0,"weight":50},{"mesh":0,"index":1,"weight":25},{"mesh":0,"index":9,"weight":100},{"mesh":3,"index":0,"weight":100}]},
        {"name":"wide","presetName":"unknown","isBinary":true,"binds":[{"mesh":0,"index":1,"weight":100}]}]}}}"#;
    for (more, name) in [(one, "blink"), (zero, "Blink")] {
        let character = read("1", more);
        let [blink, wide] = &character.body.expressions[..] else {
            panic!("{:?}", character.body.expressions)
        };
        assert_eq!((blink.name.as_str(), blink.preset, blink.is_binary), (name, Some("blink"), false));
        assert_eq!((wide.name.as_str(), wide.preset, wide.is_binary), ("wide", None, true));
        assert_eq!((&blink.morphs[..], &wide.morphs[..]), (&[(0, 0.5), (1, 0.25)][..], &[(1, 1.0)][..]));
        assert_eq!(character.dropped.get("parts_of_expressions"), Some(&2), "{:?}", character.dropped);
        let mut weights = FaceWeights::default();
        weights.set(name, 0.5);
        let mut pose = Pose::default();
        pose_at(&character.body, None, 0.0, &mut pose);
        Face::new(&character.body, &weights).apply(&mut pose.morph_weights);
        assert_eq!(pose.morph_weights, [0.25, 0.125]);
    }
}

#[test]
fn a_morph_target_of_another_mesh_is_left_out() {
    let character = read("2", "");
    assert_eq!(character.dropped.get("morph_targets_of_other_meshes"), Some(&1));
    let morphs = &character.body.skin.morphs;
    assert_eq!((morphs.len(), morphs[0].vertices.len(), morphs[1].vertices.len()), (2, 1, 0));
}

#[test]
fn a_thousand_expressions_open() {
    let bind = r#"{"morphTargetBinds":[{"node":0,"index":0,"weight":1}]}"#;
    let all: Vec<String> = (0..1000).map(|k| format!(r#""e{k}":{bind}"#)).collect();
    let more =
        format!(r#","extensions":{{"VRMC_vrm":{{"expressions":{{"custom":{{{}}}}}}}}}"#, all.join(","));
    let body = read("1", &more).body;
    assert_eq!((body.expressions.len(), lovelock_motion::face_names(&body).len()), (1000, 1000));
}

#[test]
fn a_vrm_animation_has_the_weights_of_expressions_along_x() {
    let more = r#","extensions":{"VRMC_vrm_animation":{"specVersion":"1.0","expressions":{"preset":{"happy":{"node":1}}}}}"#;
    let motion = load_motion_bytes("x.vrma", &figure("1", more), MotionSettings::default());
    let motion = motion.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(motion.faces.len(), 1);
    assert_eq!((motion.faces[0].name.as_str(), motion.faces[0].track.at(0.5)), ("happy", 0.25));
}
