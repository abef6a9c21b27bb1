//! `lovelock presets`, and styles as files.

use std::collections::BTreeSet;

use crate::tool::{lovelock, names, run, run_command};

#[test]
fn styles_are_listed_for_people_and_for_other_programs() {
    let dir = tempfile::tempdir().expect("a folder");
    let listed = run(dir.path(), ["presets", "--json"]).done().json();
    let presets = listed["presets"].as_array().expect("a list");
    let ids: BTreeSet<&str> = presets.iter().filter_map(|preset| preset["id"].as_str()).collect();
    for id in ["smooth", "curly", "long", "ponytail", "bun", "bob", "afro"] {
        assert!(ids.contains(id), "{id}");
    }
    assert_eq!(ids.len(), presets.len(), "each once");
    for preset in presets {
        assert!(preset["label"].is_string() && preset["strands"].as_u64() > Some(300), "{preset}");
        assert!(preset.get("thumbnail").is_some(), "{preset}");
    }
    let listed = run(dir.path(), ["presets", "--preset", "curly"]);
    let text = &listed.done().stdout;
    assert!(text.starts_with("curly  Red curls") && text.lines().count() == 1, "{text}");
}

#[test]
fn a_style_of_ones_own_is_listed_drawn_and_recorded() {
    let dir = tempfile::tempdir().expect("a folder");
    let folder = dir.path().join("data/lovelock/styles");
    std::fs::create_dir_all(&folder).expect("a folder");
    let text = "(version: 3, name: \"Few\", hair: (groom: (wisps: 30, strands_per_wisp: 4, segments_per_strand: 8)))";
    std::fs::write(folder.join("few ü.lovelockstyle"), text).expect("a file");
    std::fs::write(folder.join("cut.lovelockstyle"), "(version: 3, hair: (").expect("a file");
    let own = |args: &[&str]| {
        let mut command = lovelock();
        command.current_dir(dir.path()).args(args);
        // Linux finds the folder by this name; elsewhere the system's own stays.
        run_command(command.env("XDG_DATA_HOME", dir.path().join("data")).env("XDG_CACHE_HOME", dir.path()))
    };
    if cfg!(target_os = "linux") {
        let listed = own(&["presets", "--json"]).done().json();
        let last = listed["presets"].as_array().and_then(|list| list.last()).expect("a style").clone();
        assert_eq!((last["id"].as_str(), last["strands"].as_u64()), (Some("own/few ü"), Some(120)));
        assert!(listed["notes"][0].as_str().is_some_and(|note| note.contains("cut.lovelockstyle")));
        own(&["presets", "--preset", "few", "--sheet", "a b.png", "--size", "32x40"]).done();
        assert!(names(dir.path()).contains(&"a b.png".to_owned()));
    }
    let file = "data/lovelock/styles/few ü.lovelockstyle";
    let described = own(&["info", file, "--json"]).done().json();
    assert_eq!((described["kind"].as_str(), described["name"].as_str()), (Some("style"), Some("Few")));
    let recorded = own(&[
        "record",
        "--preset",
        file,
        "-o",
        "out",
        "--frames",
        "0..1",
        "--size",
        "32x32",
        "--backend",
        "cpu",
        "--set",
        "timeline.preroll_secs=0",
        "--json",
    ]);
    assert_eq!(recorded.done().json()["strands"].as_u64(), Some(120));
}

#[test]
fn thumbnails_are_written_for_the_program() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("few.lovelockstyle");
    let text = "(version: 3, hair: (groom: (wisps: 30, strands_per_wisp: 4, segments_per_strand: 8)))";
    std::fs::write(&path, text).expect("a file");
    let listed = run(dir.path(), ["presets", "--preset", "few.lovelockstyle", "--thumbnails", "t", "--json"]);
    let thumbnail = listed.done().json()["presets"][0]["thumbnail"].as_str().expect("a file").to_owned();
    let bytes = std::fs::read(dir.path().join(thumbnail)).expect("a picture");
    assert!(bytes.starts_with(&[0xff, 0xd8]) && bytes.len() <= 12 * 1024, "{} bytes", bytes.len());
}
