//! `lovelock info` on real files and on broken ones.

use std::path::Path;

use serde_json::{Value, json};

use crate::tool::run;

/// A file in the folder of real files, and the values that must be reported for it.
type Fact = (&'static str, Value);

#[track_caller]
fn report_of(data: &Path, file: &str) -> Value {
    let ran = run(data, ["info", "--json", file]);
    let json = ran.done().json();
    assert_eq!(json["file"], file);
    assert!(json["format"].is_string() && json["notes"].is_array() && json["dropped"].is_object(), "{json}");
    json
}

/// Checks that `report` has every field of `facts`, with numbers equal to within a thousandth.
#[track_caller]
fn assert_facts(file: &str, report: &Value, facts: &Value) {
    for (key, wanted) in facts.as_object().expect("facts") {
        let found = &report[key];
        let same = match (found.as_f64(), wanted.as_f64()) {
            (Some(found), Some(wanted)) => (found - wanted).abs() <= 1e-3 * wanted.abs(),
            _ => found == wanted,
        };
        assert!(same, "{file}: {key} is {found}, not {wanted}");
    }
}

#[test]
fn hair_files_are_described() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let hair = |strands: u64, points: u64| json!({"kind": "hair", "strands": strands, "points": points, "segments": points - strands});
    let files: [Fact; 9] = [
        ("hair/yuksel/straight.hair", hair(10_000, 160_000)),
        ("hair/tressfx/Ratboy_mohawk.tfx", hair(2_228, 71_296)),
        ("hair/tressfx/Ratboy_mohawk_v40.tfx", hair(2_226, 71_232)),
        ("hair/tressfx/TestHair1.tfx", hair(10_027, 40_108)),
        ("hair/tressfx/back.tfx", hair(517, 8_272)),
        ("hair/tressfx/front_top.tfx", hair(876, 14_016)),
        ("hair/tressfx/side.tfx", hair(3_066, 49_056)),
        ("hair/tressfx/sintel_16pt.tfx", hair(11_400, 182_400)),
        ("hair/tressfx/sintel_vk.tfx", hair(228, 7_296)),
    ];
    for (file, facts) in files {
        let report = report_of(&data, file);
        assert_facts(file, &report, &facts);
        assert_eq!(report["dropped"], json!({}), "{file}");
        let size = |axis: usize| {
            report["bounds_m"]["max"][axis].as_f64().expect("metres")
                - report["bounds_m"]["min"][axis].as_f64().expect("metres")
        };
        // The size of hair on a head in metres, whatever the unit of the file.
        assert!((0..3).all(|axis| (0.05..1.5).contains(&size(axis))), "{file}: {}", report["bounds_m"]);
    }
    let straight = report_of(&data, "hair/yuksel/straight.hair");
    assert_facts("straight.hair", &straight, &json!({"up": "z", "facing": "+y", "unit_guessed": true}));
    assert_eq!(report_of(&data, "hair/tressfx/Ratboy_mohawk.tfx")["unit"], "m");
    assert_eq!(
        report_of(&data, "hair/tressfx/Ratboy_mohawk_v40.tfx")["unit"],
        "cm",
        "the same groom a hundred times larger"
    );
}

#[test]
fn an_up_axis_is_guessed_doubted_and_set() {
    let dir = tempfile::tempdir().expect("a folder");
    // Strands along X, too few to be sure of.
    let strands: Vec<String> = (0..3)
        .map(|k| format!("v 0 0.1 0.0{k}\nv -0.1 0.1 0.0{k}\nv -0.2 0.1 0.0{k}\nl -3 -2 -1\n"))
        .collect();
    std::fs::write(dir.path().join("a.obj"), strands.concat()).expect("a file");
    let info = run(dir.path(), ["info", "a.obj"]);
    assert!(info.done().stdout.contains("in doubt") && info.stdout.contains("--up"), "{info:?}");
    for axis in ["x", "-x", "-y", "-z"] {
        let json = run(dir.path(), ["info", "--json", "--up", axis, "a.obj"]).done().json();
        assert_eq!((json["up"].as_str(), json["up_confidence"].as_f64()), (Some(axis), Some(1.0)), "{json}");
        assert!(!json["notes"].to_string().contains("--up"), "{json}");
    }
    let converted = run(dir.path(), ["convert", "a.obj", "b.obj", "--up", "x", "--unit", "m"]);
    assert!(!converted.done().stdout.contains("in doubt"), "{converted:?}");
    let b = std::fs::read_to_string(dir.path().join("b.obj")).expect("a file");
    let heights: Vec<f32> = (b.lines().filter(|line| line.starts_with("v ")))
        .filter_map(|line| line.split_whitespace().nth(2)?.parse().ok())
        .collect();
    assert!(heights[2] < heights[0] - 0.19, "they hang: {heights:?}");
    let line = run(dir.path(), ["info", "a.obj", "--up", "w"]).refused(2).to_owned();
    assert!(line.contains("-x, y, -y, z or -z"), "{line}");
    let line = run(dir.path(), ["record", "--up", "x", "-o", "c.usda"]).refused(2).to_owned();
    assert!(line.contains("--up: found no hair file"), "{line}");
}

#[test]
fn characters_are_described() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let files: [Fact; 9] = [
        ("characters/CesiumMan.glb", json!({"joints": 19, "skins": 1, "vertices": 3273, "triangles": 4672})),
        ("characters/CesiumMan_quantized.glb", json!({"joints": 19, "vertices": 3273, "height_m": 1.5065})),
        ("characters/Fox.glb", json!({"joints": 24, "vertices": 1728, "triangles": 576})),
        ("characters/Fox_cubicspline_step.glb", json!({"joints": 24, "vertices": 1728})),
        ("characters/MorphStressTest.gltf", json!({"morph_targets": 8})),
        ("characters/MorphStress_sparse.glb", json!({"morph_targets": 8})),
        ("characters/SimpleSkin.gltf", json!({"joints": 2, "skins": 1})),
        ("characters/mh_body.glb", json!({"joints": 163, "vertices": 13_380, "head": "head"})),
        ("characters/robot.glb", json!({"joints": 43})),
    ];
    for (file, facts) in files {
        let report = report_of(&data, file);
        assert_eq!(report["kind"], "character", "{file}");
        assert_facts(file, &report, &facts);
        assert_eq!(report["dropped"], json!({}), "{file}");
    }
    let clips = |file| {
        let report = report_of(&data, file);
        let clips = report["clips"].as_array().expect("clips").clone();
        clips
            .into_iter()
            .map(|clip| {
                (
                    clip["name"].as_str().unwrap_or("").to_owned(),
                    clip["duration_secs"].as_f64().unwrap_or(0.0),
                )
            })
            .collect::<Vec<_>>()
    };
    let robot = clips("characters/robot.glb");
    assert_eq!(robot.len(), 14);
    // The duration that the makers of the file state.
    assert!(
        robot.iter().any(|(name, secs)| name == "Robot_Dance" && (secs - 3.333).abs() < 1e-3),
        "{robot:?}"
    );
    assert_eq!(clips("characters/Fox.glb").len(), 3);
    assert_eq!(clips("characters/Fox_cubicspline_step.glb").len(), 5);
    assert_eq!(clips("characters/MorphStressTest.gltf").len(), 3);
    assert_eq!(clips("characters/CesiumMan.glb").len(), 1);
}

#[test]
fn motions_are_described() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let files: [Fact; 6] = [
        ("motion/jesse_dance.bvh", json!({"joints": 60, "frames": 1007, "frame_secs": 0.01})),
        ("motion/cmu1_jumping_jacks.bvh", json!({"joints": 31, "frames": 125})),
        ("motion/fair1_dab.bvh", json!({"joints": 27, "frames": 339})),
        ("motion/mh_tpose.bvh", json!({"joints": 173, "frames": 1})),
        ("motion/mh_walk1.bvh", json!({"joints": 75, "frames": 14})),
        // Its header states one frame less than the file has.
        ("motion/assimp_Boxing_Toes.bvh", json!({"joints": 21, "frames": 3070})),
    ];
    for (file, facts) in files {
        let report = report_of(&data, file);
        assert_eq!(report["kind"], "motion", "{file}");
        assert_facts(file, &report, &facts);
    }
    let boxing = report_of(&data, "motion/assimp_Boxing_Toes.bvh");
    assert!(boxing["notes"].to_string().contains("3069"), "the wrong header is not reported: {boxing}");
}

#[test]
fn broken_files_are_repaired_or_rejected() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    // The counts of what is dropped, or a word of the error.
    let files: [(&str, Result<Value, &str>); 25] = [
        ("hair/broken/allflags.hair", Ok(json!({}))),
        ("hair/broken/nosegs.hair", Ok(json!({}))),
        ("hair/broken/variable_odd.hair", Ok(json!({}))),
        ("hair/broken/tfx_6verts.tfx", Ok(json!({}))),
        ("hair/broken/tiny_units.hair", Ok(json!({}))),
        ("hair/broken/trailing.hair", Ok(json!({"trailing_bytes": 37}))),
        ("hair/broken/onepoint.hair", Ok(json!({"one_point_strands": 2}))),
        ("hair/broken/zerolen.hair", Ok(json!({"repeated_points": 2, "zero_length_strands": 1}))),
        ("hair/broken/nan_inf.hair", Ok(json!({"distant_strands": 1, "non_finite_strands": 2}))),
        ("hair/broken/allonepoint.hair", Err("two points")),
        ("hair/broken/badmagic.hair", Err("HAIR")),
        ("hair/broken/countlie.hair", Err("1000 points")),
        ("hair/broken/dseg0.hair", Err("56 points")),
        ("hair/broken/hugecount.hair", Ok(json!({}))),
        ("hair/broken/nopoints.hair", Err("points")),
        ("hair/broken/tfx_badoffset.tfx", Err("640 bytes")),
        ("hair/broken/truncated.hair", Err("300 bytes")),
        ("characters/broken/BoxTextured.gltf", Err("BoxTextured0.bin")),
        ("characters/broken/BoxWithInfinites.glb", Err("12 triangles")),
        ("characters/broken/IndexOutOfRange.gltf", Err("IndexOutOfRange.bin")),
        ("characters/broken/RecursiveNodes.gltf", Err("a mesh")),
        ("characters/broken/badArray.gltf", Err("line 44")),
        ("characters/CesiumMan_draco.glb", Err("KHR_draco_mesh_compression")),
        ("characters/Fox_meshopt.glb", Err("EXT_meshopt_compression")),
        ("characters/broken/quad_skin.glb", Ok(json!({"weights_beyond_eight": 2}))),
    ];
    let listed: Vec<&str> = files.iter().map(|(file, _)| *file).collect();
    for folder in ["hair/broken", "characters/broken"] {
        for name in crate::tool::names(&data.join(folder)) {
            assert!(listed.contains(&format!("{folder}/{name}").as_str()), "{folder}/{name} is not tested");
        }
    }
    for (file, wanted) in files {
        let ran = run(&data, ["info", "--json", file]);
        match wanted {
            Ok(dropped) => assert_eq!(ran.done().json()["dropped"], dropped, "{file}"),
            Err(word) => {
                let line = ran.refused(2);
                assert!(line.contains(file) && line.contains(word), "{file}: {line}");
                assert_eq!(ran.json()["error"]["file"], file);
            }
        }
    }
}

#[test]
fn info_accepts_names_that_are_not_ascii() {
    let dancer = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/dancer.glb");
    let dir = tempfile::tempdir().expect("a folder");
    let name = "eine Tänzerin – 舞.glb";
    std::fs::copy(dancer, dir.path().join(name)).expect("a copy");
    let json = run(dir.path(), ["info", "--json", name]).done().json();
    assert_eq!(
        (&json["file"], &json["kind"], &json["dropped"]),
        (&name.into(), &"character".into(), &json!({}))
    );
    assert!(json["joints"].as_u64().is_some_and(|joints| joints >= 20), "{json}");
    let dance = &json["clips"][0];
    assert_eq!(dance["name"], "dance");
    assert!(dance["duration_secs"].as_f64().is_some_and(|secs| secs >= 8.0), "{dance}");
    // Without --json the same facts are printed as text.
    let ran = run(dir.path(), ["info", name]);
    assert!(ran.done().stdout.starts_with(name) && ran.stdout.contains("character"), "{ran:?}");
}
