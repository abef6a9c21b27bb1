use super::*;

fn kind_of(info: &Info) -> &'static str {
    match info.content {
        Content::Hair(_) => "hair",
        Content::Character(_) => "character",
        Content::Motion(_) => "motion",
        Content::Project(_) => "project",
        Content::Style(_) => "style",
        Content::Take(_) => "take",
        Content::Strokes(_) => "strokes",
        Content::Surroundings(_) => "surroundings",
        Content::Sound(_) => "sound",
        Content::HairClusters(_) => "hair-clusters",
    }
}

#[test]
fn real_files_are_told_apart_and_described() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    for (file, kind) in [
        ("hair/yuksel/straight.hair", "hair"),
        ("hair/tressfx/sintel_vk.tfx", "hair"),
        ("hair/tressfx/back.tfx", "hair"),
        ("hair/gltf_lines/sintel_LINES.glb", "hair"),
        ("hair/gltf_lines/sintel_LINE_STRIP_x228.glb", "hair"),
        ("hair/pbrt/straight_300.pbrt", "hair"),
        ("hair/pbrt/syntax_mix.pbrt", "hair"),
        ("characters/CesiumMan.glb", "character"),
        ("characters/SimpleSkin.gltf", "character"),
        ("motion/cmu1_jumping_jacks.bvh", "motion"),
    ] {
        let info = info(&data.join(file)).expect(file);
        assert_eq!(kind_of(&info), kind, "{file}");
        let json = serde_json::to_value(&info).expect("JSON");
        assert_eq!(json["kind"], kind);
        for key in ["file", "format", "dropped", "notes"] {
            assert!(!json[key].is_null(), "{file} lacks `{key}`: {json}");
        }
        assert!(info.to_string().lines().count() > 3);
    }
    let json =
        serde_json::to_value(info(&data.join("hair/yuksel/straight.hair")).expect("hair")).expect("JSON");
    assert_eq!((&json["strands"], &json["points"]), (&10_000.into(), &160_000.into()));
    assert!(json["bounds_m"]["min"].is_array() && json["unit_guessed"].is_boolean());
}

#[test]
fn broken_files_are_counted_or_refused_in_one_line_with_exit_2() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    for folder in ["hair/broken", "characters/broken"] {
        for entry in std::fs::read_dir(data.join(folder)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if let Err(error) = info(&path) {
                let text = error.to_string();
                assert_eq!(error.exit_code(), 2, "{text}");
                assert_eq!(error.file(), Some(path.as_path()));
                assert_eq!(text.lines().count(), 1, "{text}");
                let name = path.file_name().expect("a name").to_string_lossy();
                assert!(text.contains(&*name), "{text} does not name {name}");
            }
        }
    }
}

#[test]
fn a_picture_of_the_surroundings_is_described() {
    let dir = tempfile::tempdir().expect("a folder");
    // The content decides on the kind, not the name.
    let path = dir.path().join("sky");
    exr::prelude::write_rgb_file(&path, 24, 8, |_, y| if y == 0 { (9.0, 6.0, 3.0) } else { (0.1, 0.1, 0.1) })
        .expect("a picture");
    let sky = info(&path).expect("a picture");
    assert_eq!(kind_of(&sky), "surroundings");
    let json = serde_json::to_value(&sky).expect("JSON");
    assert_eq!(json["kind"], "surroundings");
    assert_eq!(
        (&json["format"], &json["width"], &json["height"]),
        (&"OpenEXR".into(), &24.into(), &8.into())
    );
    assert!(json["notes"].as_array().is_some_and(|notes| notes.len() == 1), "stretched: {json}");
    assert!(sky.to_string().contains("24 x 8 pixels"), "{sky}");
    let broken = dir.path().join("broken.hdr");
    std::fs::write(&broken, "#?RADIANCE").expect("a file");
    let error = info(&broken).expect_err("no picture");
    assert!(error.exit_code() == 2 && error.to_string().contains("broken.hdr"), "{error}");
}

#[test]
fn a_project_tells_what_it_names_and_what_is_missing() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("p.lovelock");
    let mut project = lovelock_project::Project::default();
    project.set_motion_file(dir.path().join("gone.bvh"));
    lovelock_project::project::save_project(&path, &project).expect("saved");
    let json = serde_json::to_value(info(&path).expect("a project")).expect("JSON");
    assert_eq!((&json["kind"], &json["hair"]), (&"project".into(), &"smooth".into()));
    assert!(json["notes"].to_string().contains("gone.bvh"));
}

#[test]
fn a_style_is_described() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("s.lovelockstyle");
    let text = "(version: 3, name: \"Mine\", tags: [\"Short\"], sparkle: 1, hair: (groom: (wisps: 100, \
                strands_per_wisp: 10), stack: (layers: [(operation: (kind: \"curl\"))])))";
    std::fs::write(&path, text).expect("a file");
    let json = serde_json::to_value(info(&path).expect("a style")).expect("JSON");
    assert_eq!(
        (&json["kind"], &json["name"], &json["strands"]),
        (&"style".into(), &"Mine".into(), &1000.into())
    );
    assert_eq!((&json["tags"][0], &json["dropped"]["unknown_fields"]), (&"short".into(), &1.into()));
    assert!(info(&path).expect("a style").to_string().contains("Curl"));
}

#[test]
fn strokes_are_described() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a ü.lovelockstrokes");
    let text = "(version: 1, strokes: [(tool: comb, samples: [(time_secs: 0.5), (time_secs: 2.0)]), \
                (tool: curl, samples: [(time_secs: 0.25)]), (tool: comb)])";
    std::fs::write(&path, text).expect("a file");
    let found = info(&path).expect("strokes");
    assert_eq!(kind_of(&found), "strokes");
    let json = serde_json::to_value(&found).expect("JSON");
    assert_eq!((&json["kind"], &json["format"]), (&"strokes".into(), &"Lovelock strokes 1".into()));
    assert_eq!((&json["strokes"], &json["samples"]), (&3.into(), &3.into()));
    assert_eq!(json["tools"], serde_json::json!(["comb", "curl"]));
    assert_eq!((&json["start_secs"], &json["end_secs"]), (&0.25.into(), &2.0.into()));
    assert!(found.to_string().contains("0.25 s to 2.00 s"), "{found}");
    std::fs::write(&path, "(version: 1, strokes: [])").expect("a file");
    let json = serde_json::to_value(info(&path).expect("no strokes")).expect("JSON");
    assert!(json["strokes"] == 0 && json["start_secs"].is_null(), "{json}");
    std::fs::write(&path, "(version: 7, strokes: [])").expect("a file");
    let error = info(&path).expect_err("another version");
    assert!(error.exit_code() == 2 && error.to_string().contains("a ü.lovelockstrokes"), "{error}");
}

#[test]
fn curves_whose_motion_is_refused_are_described_with_the_reason() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = dir.path().join("grows.usda");
    for (counts, said) in [("[2], 2: [1]", "cannot be played"), ("[2], 2: [2]", "The curves move: 2 times")] {
        let text = format!(
            "#usda 1.0\ndef BasisCurves \"a\"\n{{\n uniform token type = \"linear\"\n\
             int[] curveVertexCounts.timeSamples = {{ 1: {counts} }}\n\
             point3f[] points.timeSamples = {{ 1: [(0, 0, 0), (0, 1, 0)], 2: [(0, 0, 0), (0, 2, 0)] }}\n}}\n"
        );
        std::fs::write(&at, text).expect("a file");
        let json = serde_json::to_value(info(&at).expect("hair")).expect("JSON");
        let notes = json["notes"].to_string();
        assert!(notes.contains(said), "{notes}");
        assert_eq!(notes.contains("number of points changes"), said == "cannot be played", "{notes}");
    }
}

#[test]
fn content_speaks_before_the_ending() {
    let dir = tempfile::tempdir().expect("a folder");
    for (name, content, kind) in [
        ("a.txt", &b"HIERARCHY\nROOT"[..], Some(FileKind::Motion)),
        ("b.bvh", b"HAIR....", Some(FileKind::Hair)),
        (
            "c",
            b"  {\"scene\":0,\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[{}]}]}",
            Some(FileKind::Character),
        ),
        ("d.dat", b"\xef\xbb\xbf(\n version: 1)", Some(FileKind::Project)),
        ("d.lovelockstyle", b"(version: 3)", Some(FileKind::Style)),
        ("e.lovelockstyle", b"HAIR....", Some(FileKind::Hair)),
        // Their text would be an empty project, which replaces them when it is saved.
        ("e.lovelockstrokes", b"(version: 1, strokes: [])", Some(FileKind::Strokes)),
        ("e.ron", b"(version: 1, strokes: [])", Some(FileKind::Project)),
        ("e.HAIR", b"nonsense", Some(FileKind::Hair)),
        ("f.gltf", b"{\"asset\":{},\"meshes\":[{\"primitives\":[{\"mode\":3}]}]}", Some(FileKind::Hair)),
        ("g.gltf", b"{\"asset\":{},\"meshes\":[{\"primitives\":[{\"mode\":4}]}]}", Some(FileKind::Character)),
        ("g.glb", b"glTF\x02\0\0\0", Some(FileKind::Character)),
        ("h.obj", b"v 0 0 0\nl 1 2", Some(FileKind::Hair)),
        ("i.pbrt.gz", b"\x1f\x8b\x08", Some(FileKind::Hair)),
        ("j.gltf", b"{\"asset\":{},\"animations\":[{}]}", Some(FileKind::Motion)),
        ("k.vrma", b"{\"asset\":{},\"animations\":[{}]}", Some(FileKind::Motion)),
        ("f.txt", b"nonsense", None),
        ("g", b"", None),
    ] {
        let path = dir.path().join(name);
        std::fs::write(&path, content).expect("a file");
        match (FileKind::of(&path), kind) {
            (Ok(found), Some(kind)) => assert_eq!(found, kind, "{name}"),
            (Err(error), None) => {
                assert!(error.to_string().contains(".tfx") && error.exit_code() == 2, "{error}");
            }
            (other, _) => panic!("{name}: {other:?}"),
        }
    }
    // A body with a clip is a body, and hair with a body is hair.
    for (name, content, kind) in [
        (
            "l.gltf",
            "{\"asset\":{},\"animations\":[{}],\"meshes\":[{\"primitives\":[{}]}]}",
            FileKind::Character,
        ),
        ("m.gltf", "{\"asset\":{},\"meshes\":[{\"primitives\":[{},{\"mode\":1}]}]}", FileKind::Hair),
        ("n.usda", "#usda 1.0\ndef BasisCurves \"a\" {}\ndef Mesh \"b\" {}\n", FileKind::Hair),
        ("o.usda", "#usda 1.0\ndef SkelAnimation \"a\" {}\ndef Mesh \"b\" {}\n", FileKind::Character),
        ("p.usda", "#usda 1.0\ndef Skeleton \"a\" {}\ndef SkelAnimation \"b\" {}\n", FileKind::Motion),
    ] {
        let path = dir.path().join(name);
        std::fs::write(&path, content).expect("a file");
        assert_eq!(FileKind::of(&path).expect(name), kind, "{name}");
    }
    for (name, content) in [
        ("q.usda", "#usda 1.0\ndef Camera \"a\" {}\n"),
        ("r.usda", "#usda 1.0\ndef Skeleton \"a\" {}\n"),
        ("s.gltf", "{\"asset\":{},\"nodes\":[{}]}"),
        ("t.gltf", "{\"asset\":{},\"meshes\":[{\"primitives\":[{\"mode\":0}]}]}"),
    ] {
        let path = dir.path().join(name);
        std::fs::write(&path, content).expect("a file");
        let error = FileKind::of(&path).expect_err(name);
        let said = error.to_string();
        assert!(said.contains(name) && said.contains("neither hair nor a mesh nor animation"), "{said}");
        assert_eq!((said.lines().count(), error.exit_code()), (1, 2));
    }
    assert!(FileKind::of(dir.path()).is_err(), "a folder");
    assert!(FileKind::of(&dir.path().join("gone.hair")).is_err(), "a missing file");
}

#[test]
fn a_database_of_hair_clusters_is_described() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("a ü.bin");
    let report = crate::satf::build_satf(&path, &|_| ()).expect("a database");
    let found = info(&path).expect("a description");
    let Content::HairClusters(described) = &found.content else { panic!("{found:?}") };
    assert_eq!((described.sectors, &described.checksum), (384, &report.checksum));
    assert!(found.to_string().contains("384 sectors"), "{found}");
    let mut bytes = std::fs::read(&path).expect("bytes");
    bytes.truncate(1000);
    std::fs::write(&path, &bytes).expect("written");
    let error = info(&path).expect_err("cut short");
    assert!(error.to_string().contains("a ü.bin") && error.exit_code() == 2, "{error}");
    // A file that only begins alike is none. Files of hair end in `.bin`, too.
    for (name, said) in [("a ü.bin", "must be the number of strands"), ("a", "found an unknown kind of file")]
    {
        let other = dir.path().join(name);
        std::fs::write(&other, b"LVLKSA").expect("written");
        assert!(info(&other).is_err_and(|error| error.to_string().contains(said)), "{name}");
    }
}

#[test]
fn a_sound_is_described_with_its_tempo() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("clicks ü.wav");
    lovelock_testkit::click_track(&path, 8);
    let info = info(&path).expect("a sound");
    assert_eq!(kind_of(&info), "sound");
    let json = serde_json::to_value(&info).expect("JSON");
    assert_eq!(
        (&json["rate"], &json["channels"], &json["duration_secs"]),
        (&48_000.into(), &1.into(), &8.0.into())
    );
    assert!((json["tempo"].as_f64().expect("a tempo") - 120.0).abs() < 1.0, "{json}");
    let text = info.to_string();
    assert!(text.contains("sound, WAV (pcm_s16le)") && text.contains("120.0 beats per minute"), "{text}");
    std::fs::write(&path, b"RIFF\0\0\0\0WAVE and nothing more").expect("a file");
    let error = super::info(&path).expect_err("no sound");
    assert!(error.exit_code() == 2 && error.to_string().contains("clicks ü.wav"), "{error}");
}

#[test]
fn the_surface_of_a_character_is_described() {
    let figure = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    let info = info(&figure).expect("the dancer");
    let json = serde_json::to_value(&info).expect("JSON");
    let list = |key: &str| json[key].as_array().unwrap_or_else(|| panic!("{key}: {json}")).clone();
    let (materials, textures) = (list("materials"), list("textures"));
    let regions: Vec<_> = materials.iter().filter_map(|material| material["region"].as_str()).collect();
    assert!(
        regions.contains(&"skin") && regions.contains(&"eye") && regions.contains(&"cloth"),
        "{regions:?}"
    );
    let triangles: u64 = materials.iter().filter_map(|material| material["triangles"].as_u64()).sum();
    assert_eq!(Some(triangles), json["triangles"].as_u64());
    for of in materials.iter().flat_map(|material| material["textures"].as_array().expect("textures")) {
        assert!(of["texture"].as_u64().is_some_and(|index| (index as usize) < textures.len()), "{of}");
    }
    assert!(textures.iter().all(|texture| texture["width"].as_u64() > Some(0)) && !textures.is_empty());
    assert_eq!(Some(list("morph_target_names").len() as u64), json["morph_targets"].as_u64());
    let text = info.to_string();
    for name in ["material", "texture", "morphs"] {
        assert!(text.contains(&format!("\n  {name:<9} ")), "{name}: {text}");
    }
}
