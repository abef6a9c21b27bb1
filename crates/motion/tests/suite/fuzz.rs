//! Corrupt bytes: every truncation and every flipped bit gives an error or a character, never a panic or a
//! hang.

use crate::common;

use lovelock_motion::{MotionSettings, load_character_bytes, load_motion_bytes};
use lovelock_testkit::fuzz::damaged;

/// A small skinned, morphed and animated figure: a valid file to corrupt.
fn glb() -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let mut floats = |values: &[f32]| {
        let at = bin.len();
        bin.extend(values.iter().flat_map(|v| v.to_le_bytes()));
        at
    };
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    floats(&[0.5, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.25, 0.75, 0.0, 0.0]);
    floats(&[0.0, 1.0]);
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.707, 0.0, 0.707]);
    bin.extend([0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 0]);
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,2]}}],
        "nodes":[{{"name":"hips","children":[1]}},{{"name":"head","translation":[0,1,0]}},{{"mesh":0,"skin":0}}],
        "skins":[{{"joints":[0,1]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"WEIGHTS_0":1,"JOINTS_0":4}},"indices":5,
        "targets":[{{"POSITION":6}}]}}]}}],
        "animations":[{{"samplers":[{{"input":2,"output":3}}],"channels":[{{"sampler":0,"target":{{"node":1,"path":"rotation"}}}}]}}],
        "accessors":[
        {{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
        {{"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC4"}},
        {{"bufferView":0,"byteOffset":84,"componentType":5126,"count":2,"type":"SCALAR"}},
        {{"bufferView":0,"byteOffset":92,"componentType":5126,"count":2,"type":"VEC4"}},
        {{"bufferView":0,"byteOffset":124,"componentType":5121,"count":3,"type":"VEC4"}},
        {{"bufferView":0,"byteOffset":136,"componentType":5121,"count":3,"type":"SCALAR"}},
        {{"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":1,"indices":{{"bufferView":0,"byteOffset":137,
        "componentType":5121}},"values":{{"bufferView":0,"byteOffset":12}}}}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{0}}}],"buffers":[{{"byteLength":{0}}}]}}"#,
        bin.len()
    );
    common::glb(json, bin)
}

const BVH: &str = "HIERARCHY\nROOT Hips\n{\n OFFSET 0 90 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation \
    Yrotation\n JOINT Head\n {\n  OFFSET 0 60 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n  End Site\n  {\n   OFFSET \
    0 20 0\n  }\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.033\n0 90 0 1 2 3 4 5 6\n0 91 0 1 2 3 4 5 7\n";

#[test]
fn the_original_files_are_valid() {
    let character = load_character_bytes("x.glb", &glb(), None).unwrap();
    assert_eq!((character.joints, character.clips.len(), character.body.skin.morphs.len()), (2, 1, 1));
    assert_eq!(character.body.skin.morphs[0].vertices, [1]);
    assert!(character.dropped.is_empty(), "{:?}", character.dropped);
    assert_eq!(load_motion_bytes("x.bvh", BVH.as_bytes(), MotionSettings::default()).unwrap().frames, 2);
}

#[test]
fn every_truncation_is_handled() {
    let (glb, bvh) = (glb(), BVH.as_bytes());
    for cut in 0..glb.len() {
        assert!(load_character_bytes("x.glb", &glb[..cut], None).is_err(), "{cut}");
    }
    for cut in 0..bvh.len() {
        let _ = load_motion_bytes("x.bvh", &bvh[..cut], MotionSettings::default());
    }
}

#[test]
fn truncated_real_files_are_handled() {
    let Some(data) = common::data_dir() else { return };
    for file in ["SimpleSkin.gltf", "Fox.glb", "broken/quad_skin.glb", "CesiumMan_quantized.glb"] {
        let bytes = std::fs::read(data.join("characters").join(file)).unwrap();
        for k in 0..40 {
            let cut = bytes.len() * k / 40;
            assert!(load_character_bytes(file, &bytes[..cut], None).is_err(), "{file} {cut}");
        }
    }
    let bytes = std::fs::read(data.join("motion/cmu1_jumping_jacks.bvh")).unwrap();
    for k in 0..40 {
        let _ = load_motion_bytes("cmu", &bytes[..bytes.len() * k / 40], MotionSettings::default());
    }
}

/// The document of [`glb`] with its buffer as a data URI.
fn gltf() -> Vec<u8> {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let glb = glb();
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut document: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let mut text = String::from("data:application/octet-stream;base64,");
    for three in glb[20 + length + 8..].chunks(3) {
        let word =
            three.iter().fold(0_u32, |word, &byte| word << 8 | u32::from(byte)) << (8 * (3 - three.len()));
        text.extend((0..=three.len()).map(|k| char::from(DIGITS[(word >> (18 - 6 * k) & 63) as usize])));
    }
    document["buffers"][0]["uri"] = text.into();
    document.to_string().into_bytes()
}

#[test]
fn damaged_character_glb() {
    damaged("glb", &[glb()], 3000, |bytes| common::reads_character("a.glb", bytes));
}

#[test]
fn damaged_character_gltf() {
    damaged("gltf", &[gltf()], 3000, |bytes| common::reads_character("a.gltf", bytes));
}

#[test]
fn damaged_motion_bvh() {
    let positions = BVH.replace("CHANNELS 3 ", "CHANNELS 6 Xposition Yposition Zposition ");
    let positions = positions.replace("4 5 6\n", "0 60 0 4 5 6\n").replace("4 5 7\n", "0 60 0 4 5 7\n");
    damaged("bvh", &[BVH.into(), positions.into_bytes()], 3000, |bytes| {
        common::reads_motion("a.bvh", bytes, MotionSettings::default())
    });
}
