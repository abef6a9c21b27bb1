//! Documents built by hand, with every spelling of a line.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::Vec3;
use lovelock_base::watch::Watch;
use lovelock_testkit::clock::thread_time;
use serde_json::{Value, json};

use super::{GltfContent, gltf_content};
use crate::{HairFile, load_hair, load_hair_bytes, load_hair_watched};

/// Nine points on the X axis as floats, radii, and a few lists of indices: 9 x 12 bytes, 9 x 4, then 8 x u16.
fn buffer() -> Vec<u8> {
    let mut bytes = Vec::new();
    for i in 0..9 {
        bytes.extend([i as f32, 0.0, 0.0].into_iter().flat_map(f32::to_le_bytes));
    }
    bytes.extend((0..9).flat_map(|i| (0.001 * i as f32).to_le_bytes()));
    bytes.extend([0_u16, 1, 1, 2, 4, 5, 5, 6].into_iter().flat_map(u16::to_le_bytes));
    bytes
}

fn document(primitive: &Value, uri: &str) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "translation": [0, 1, 0], "scale": [0.1, 0.1, 0.1], "children": [1] },
            { "rotation": [0, 0, 0.5_f64.sqrt(), 0.5_f64.sqrt()], "mesh": 0 },
        ],
        "meshes": [{ "primitives": [primitive] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 9, "type": "VEC3" },
            { "bufferView": 0, "byteOffset": 108, "componentType": 5126, "count": 9, "type": "SCALAR" },
            { "bufferView": 0, "byteOffset": 144, "componentType": 5123, "count": 8, "type": "SCALAR" },
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 160 }],
        "buffers": [{ "byteLength": 160, "uri": uri }],
    })
}

fn data_uri() -> String {
    format!("data:application/octet-stream;base64,{}", STANDARD.encode(buffer()))
}

fn load(primitive: &Value) -> HairFile {
    let text = document(primitive, &data_uri()).to_string();
    load_hair_bytes("a.gltf", text.as_bytes()).expect("hair")
}

/// Lines of two segments each, a primitive per strand, all on one accessor. `copies` says whether each primitive has an accessor of its own
/// to the same points instead.
fn many(primitives: usize, copies: bool) -> Vec<u8> {
    let points = 3 * primitives;
    let mut bytes: Vec<u8> =
        (0..points).flat_map(|i| [i as f32, 0.0, 0.5]).flat_map(f32::to_le_bytes).collect();
    let at = bytes.len();
    let mut accessors =
        vec![json!({ "bufferView": 0, "componentType": 5126, "count": points, "type": "VEC3" })];
    let mut list = Vec::new();
    for first in (0..points as u32).step_by(3) {
        let offset = bytes.len() - at;
        bytes.extend([first, first + 1, first + 1, first + 2].into_iter().flat_map(u32::to_le_bytes));
        accessors.push(
            json!({ "bufferView": 1, "byteOffset": offset, "componentType": 5125, "count": 4, "type": "SCALAR" }),
        );
        let indices = accessors.len() - 1;
        if copies {
            accessors.push(accessors[0].clone());
        }
        let position = if copies { accessors.len() - 1 } else { 0 };
        list.push(json!({ "mode": 1, "indices": indices, "attributes": { "POSITION": position } }));
    }
    let document = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": list }],
        "accessors": accessors,
        "bufferViews": [
            { "buffer": 0, "byteLength": at },
            { "buffer": 0, "byteOffset": at, "byteLength": bytes.len() - at },
        ],
        "buffers": [{ "byteLength": bytes.len() }],
    });
    let mut file =
        lovelock_gltf::glb::head(document.to_string().into_bytes(), bytes.len() as u64).expect("a head");
    file.extend(bytes);
    file
}

#[test]
fn primitives_that_share_points_decode_them_once() {
    let (few, most) = (many(200, false), many(2000, false));
    let secs = |file: &[u8], strands: usize| {
        let read = || {
            let start = thread_time();
            let hair = load_hair_bytes("a.glb", file).expect("hair");
            assert_eq!((hair.strands(), hair.points.len()), (strands, 3 * strands));
            assert_eq!(hair.strand(strands - 1)[2], Vec3::new(3.0 * strands as f32 - 1.0, 0.0, 0.5));
            thread_time().saturating_sub(start).as_secs_f64()
        };
        (0..if strands == 200 { 12 } else { 4 }).map(|_| read()).fold(f64::MAX, f64::min)
    };
    let (short, long) = (secs(&few, 200), secs(&most, 2000));
    println!("200 primitives in {:.2} ms, 2000 in {:.2} ms", 1e3 * short, 1e3 * long);
    // Measured: 10.
    assert!(long < 30.0 * short, "{short} s and {long} s");
    // The control: as many accessors to the same points exceed what a file of this size may decode.
    let error = load_hair_bytes("a.glb", &many(2000, true)).expect_err("too much").to_string();
    assert!(error.contains("after others at the same bytes"), "{error}");
}

/// Where point `i` of the buffer lies: a tenth of it, turned from X to Y, a metre up.
fn place(i: usize) -> Vec3 {
    Vec3::new(0.0, 1.0 + 0.1 * i as f32, 0.0)
}

fn are_close(found: &[Vec3], wanted: &[usize]) {
    assert_eq!(found.len(), wanted.len());
    for (found, &wanted) in found.iter().zip(wanted) {
        assert!(found.distance(place(wanted)) < 1e-6, "{found} for {wanted}");
    }
}

#[test]
fn every_mode_gives_its_strands() {
    let lines = load(&json!({ "mode": 1, "indices": 2, "attributes": { "POSITION": 0, "_RADIUS": 1 } }));
    assert_eq!((lines.first_point.clone(), lines.is_in_metres), (vec![0, 3, 6], true));
    are_close(lines.strand(0), &[0, 1, 2]);
    are_close(lines.strand(1), &[4, 5, 6]);
    // The width is twice the radius, in metres of the scene.
    let widths = lines.thickness.expect("widths");
    assert!((widths[5] - 0.1 * 2.0 * 0.006).abs() < 1e-7, "{widths:?}");

    let strip = load(&json!({ "mode": 3, "attributes": { "POSITION": 0 } }));
    are_close(strip.strand(0), &[0, 1, 2, 3, 4, 5, 6, 7, 8]);
    assert!(strip.thickness.is_none());
    let ring = load(&json!({ "mode": 2, "attributes": { "POSITION": 0 } }));
    are_close(ring.strand(0), &[0, 1, 2, 3, 4, 5, 6, 7, 8, 0]);
    // Without indices: (0, 1), (2, 3), (4, 5), (6, 7), none of which touch.
    assert_eq!(load(&json!({ "mode": 1, "attributes": { "POSITION": 0 } })).strands(), 4);
}

#[test]
fn buffers_beside_the_file_are_found_and_others_are_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("hair.gltf");
    std::fs::write(dir.path().join("hair 1.bin"), buffer()).expect("a file");
    let strip = json!({ "mode": 3, "attributes": { "POSITION": 0 } });
    std::fs::write(&path, document(&strip, "hair%201.bin").to_string()).expect("a file");
    assert_eq!(gltf_content(&path), Some(GltfContent { lines: true, triangles: false, clips: 0 }));
    assert_eq!(load_hair(&path).expect("hair").points.len(), 9);
    for uri in ["gone.bin", "../hair.bin", "/etc/hostname", "http://a/b.bin", "data:,x"] {
        std::fs::write(&path, document(&strip, uri).to_string()).expect("a file");
        let error = load_hair(&path).expect_err(uri).to_string();
        assert!(error.contains("buffer") && !error.contains('\n'), "{error}");
    }
    // The control: a surface is no hair.
    let surface = json!({ "attributes": { "POSITION": 0 } });
    std::fs::write(&path, document(&surface, &data_uri()).to_string()).expect("a file");
    assert_eq!(gltf_content(&path), Some(GltfContent { lines: false, triangles: true, clips: 0 }));
    assert!(load_hair(&path).expect_err("no lines").to_string().contains("no lines, and 1 primitives"));
}

#[test]
fn contradictions_are_refused() {
    let strip = json!({ "mode": 3, "attributes": { "POSITION": 0 } });
    let lines = json!({ "mode": 1, "indices": 2, "attributes": { "POSITION": 0 } });
    for (primitive, place, value, found) in [
        (&strip, "/accessors/0/count", json!(90), "accessor 0 with 90 elements of 12 bytes"),
        (&strip, "/accessors/0/count", json!(1_u64 << 60), "elements"),
        (&strip, "/accessors/0/type", json!("MAT9"), "type `MAT9`"),
        (&strip, "/accessors/0/componentType", json!(1), "component type 1"),
        (&strip, "/bufferViews/0/byteLength", json!(161), "as many as fit into its 161 bytes"),
        (&strip, "/bufferViews/0/byteStride", json!(1 << 20), "as many as fit into its 160 bytes"),
        (&strip, "/buffers/0/byteLength", json!(161), "buffer 0 with 160 bytes; must be 161"),
        (&lines, "/accessors/0/count", json!(6), "the index 6"),
        (&strip, "/nodes", json!([]), "no lines"),
    ] {
        let mut text = document(primitive, &data_uri());
        *text.pointer_mut(place).unwrap_or(&mut Value::Null) = value.clone();
        if place.ends_with("byteStride") {
            text["bufferViews"][0]["byteStride"] = value;
        }
        let error = load_hair_bytes("a.gltf", text.to_string().as_bytes()).expect_err(found).to_string();
        assert!(error.starts_with("a.gltf: ") && error.contains(found), "{place}: {error}");
    }
    // A cycle of nodes ends.
    let mut text = document(&strip, &data_uri());
    text["nodes"][1]["children"] = json!([0, 1]);
    assert_eq!(load_hair_bytes("a.gltf", text.to_string().as_bytes()).expect("hair").strands(), 1);
    // A mesh shown in very many nodes is refused before it fills memory.
    let mut text = document(&strip, &data_uri());
    text["accessors"][0] = json!({ "componentType": 5126, "count": 1 << 16, "type": "VEC3" });
    text["nodes"] = vec![json!({ "mesh": 0 }); 513].into();
    text["scenes"] = json!([{ "nodes": (0..513).collect::<Vec<_>>() }]);
    let error = load_hair_bytes("a.gltf", text.to_string().as_bytes()).expect_err("too many").to_string();
    assert!(error.contains("33554432 points at most"), "{error}");
}

#[test]
fn nodes_that_are_not_visible_hide_what_is_below_them() {
    let strip = json!({ "mode": 3, "attributes": { "POSITION": 0 } });
    let mut text = document(&strip, &data_uri());
    text["nodes"] = json!([{ "children": [1] }, { "mesh": 0 }, { "mesh": 0 }]);
    text["scenes"] = json!([{ "nodes": [0, 2] }]);
    for (node, visible, strands) in
        [(0, json!(false), 1), (1, json!(false), 1), (0, json!(true), 2), (1, json!("no"), 2)]
    {
        let mut text = text.clone();
        text["nodes"][node]["extensions"] = json!({ "KHR_node_visibility": { "visible": visible } });
        text["extensionsRequired"] = json!(["KHR_node_visibility"]);
        let hair = load_hair_bytes("a.gltf", text.to_string().as_bytes()).expect("hair");
        assert_eq!(hair.strands(), strands, "{node} {visible}");
        assert_eq!(hair.notes.iter().any(|note| note.contains("1 hidden strand")), strands == 1);
    }
}

#[test]
fn a_node_of_scale_zero_hides_and_a_flat_one_does_not() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.gltf");
    let strip = json!({ "mode": 3, "attributes": { "POSITION": 0, "_RADIUS": 1 } });
    let load = |scale: Value, include| {
        let mut text = document(&strip, &data_uri());
        text["nodes"] = json!([{ "mesh": 0 }, { "scale": scale, "children": [2] }, { "mesh": 0 }]);
        text["scenes"] = json!([{ "nodes": [0, 1] }]);
        std::fs::write(&path, text.to_string()).expect("a file");
        load_hair_watched(&path, include, &Watch::default()).expect("hair")
    };
    let shown = load(json!([0, 0, 0]), false);
    assert_eq!(shown.strands(), 1);
    assert!(shown.notes.iter().any(|note| note.starts_with("Left out 1 hidden strand")), "{:?}", shown.notes);
    let all = load(json!([0, 0, 0]), true);
    assert_eq!((all.strands(), all.strand(1)), (2, all.strand(0)));
    // Flattened and small ones are drawn.
    for (scale, width) in [(json!([1, 1, 0]), 0.002), (json!([0.01, 0.01, 0.01]), 2e-5)] {
        let hair = load(scale, false);
        assert_eq!(hair.strands(), 2);
        let found = hair.thickness.expect("widths")[10];
        assert!((found / width - 1.0).abs() < 1e-3, "{found}");
    }
}

#[test]
fn hidden_lines_beside_a_surface_make_no_hair() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a.gltf");
    let content = |hides: [bool; 2], scale: f32| {
        let mut text = document(&json!({ "mode": 3, "attributes": { "POSITION": 0 } }), &data_uri());
        let lines = text["meshes"][0].clone();
        text["meshes"] = json!([lines, { "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
        let node = |mesh: usize| json!({ "mesh": mesh, "extensions": { "KHR_node_visibility": { "visible": !hides[mesh] } } });
        text["nodes"] = json!([node(0), node(1), { "scale": [scale, scale, scale], "children": [0] }]);
        text["scenes"] = json!([{ "nodes": [1, 2] }]);
        std::fs::write(&path, text.to_string()).expect("a file");
        gltf_content(&path).expect("a document").lines
    };
    assert!(!content([true, false], 1.0) && !content([false, false], 0.0));
    // The controls: lines that are drawn, and lines without a surface that is drawn.
    assert!(content([false, false], 1.0) && content([true, true], 1.0));
}

#[test]
fn what_a_document_does_not_state_is_the_default_of_the_specification() {
    let strip = json!({ "mode": 3, "attributes": { "POSITION": 0 } });
    let load = |text: &Value| load_hair_bytes("a.gltf", text.to_string().as_bytes());
    // An accessor without bytes is zeros; the sparse ones are set.
    let mut text = document(&strip, &data_uri());
    text["nodes"] = json!([{ "mesh": 0 }]);
    text["accessors"][0] = json!({
        "componentType": 5126, "count": 3, "type": "VEC3",
        "sparse": {
            "count": 2,
            "indices": { "bufferView": 0, "byteOffset": 148, "componentType": 5123 },
            "values": { "bufferView": 0, "byteOffset": 84 },
        },
    });
    let hair = load(&text).expect("hair");
    assert_eq!(hair.points, [Vec3::ZERO, 7.0 * Vec3::X, 8.0 * Vec3::X]);
    // The scene that is named, otherwise the first one, otherwise all nodes.
    let mut text = document(&strip, &data_uri());
    text["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0 }, { "mesh": 0 }]);
    text["scenes"] = json!([{ "nodes": [0] }, { "nodes": [0, 1] }]);
    for (scene, strands) in [(json!(1), 2), (json!(0), 1), (Value::Null, 1), (json!(9), 3)] {
        text["scene"] = scene;
        assert_eq!(load(&text).expect("hair").strands(), strands, "{}", text["scene"]);
    }
    // A matrix stands for translation, rotation and scale.
    let mut text = document(&strip, &data_uri());
    text["nodes"] = json!([{ "mesh": 0, "matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 0, 1, 0, 1] }]);
    let by_matrix = load(&text).expect("hair").points;
    let half = 0.5_f64.sqrt();
    text["nodes"] =
        json!([{ "mesh": 0, "translation": [0, 1, 0], "rotation": [0, 0, half, half], "scale": [2, 2, 2] }]);
    let by_parts = load(&text).expect("hair").points;
    assert!(
        by_matrix.iter().zip(&by_parts).all(|(a, b)| a.distance(*b) < 1e-5),
        "{by_matrix:?} {by_parts:?}"
    );
    assert!(by_parts[1].distance(Vec3::new(0.0, 3.0, 0.0)) < 1e-5, "{by_parts:?}");
    // The base colour of the material, white unless it is stated.
    let mut text =
        document(&json!({ "mode": 3, "attributes": { "POSITION": 0 }, "material": 0 }), &data_uri());
    text["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorFactor": [0.2, 0, 1, 1] } }]);
    let colour = load(&text).expect("hair").colours.expect("colours")[0];
    assert!((colour[0] - 0.484_53).abs() < 1e-3 && colour[1] == 0.0 && colour[2] > 0.999, "{colour:?}");
    text["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(0);
    let colours = load(&text).expect("hair").colours.expect("colours");
    assert!((colours[1][0] - 0.484_53).abs() < 1e-3 && colours[1][2] == 0.0, "{colours:?}");
    text["materials"] = json!([{}]);
    let colours = load(&text).expect("hair").colours.expect("colours");
    assert!(colours[1][0] > 0.999, "{colours:?}");
}
