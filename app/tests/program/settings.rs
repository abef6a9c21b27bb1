//! `lovelock settings`, `--set`, and the tables of settings in the documents.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::json;

use crate::tool::{names, run, saved, small_project};

/// What to do where a document differs.
const RENEW: &str = "run `cargo xtask docs` and commit what it changes";

fn document(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn documents_contain_the_tables_that_the_program_prints() {
    let dir = tempfile::tempdir().expect("a folder");
    let page = run(dir.path(), ["settings", "--markdown"]);
    assert!(document("settings.md").trim() == page.done().stdout.trim(), "docs/settings.md differs: {RENEW}");
    for (name, tables) in [("simulation.md", 1), ("shadow_methods.md", 1)] {
        let text = document(name);
        let blocks: Vec<&str> = text.split("<!-- settings: ").skip(1).collect();
        assert_eq!(blocks.len(), tables, "docs/{name}");
        for block in blocks {
            let (section, rest) = block.split_once(" -->").expect("the end of the mark");
            let (table, _) = rest.split_once("<!-- end -->").expect("the end of the table");
            let printed = run(dir.path(), ["settings", "--markdown", section]);
            assert!(table.trim() == printed.done().stdout.trim(), "docs/{name}, {section} differs: {RENEW}");
        }
    }
}

#[test]
fn settings_are_listed_for_other_programs() {
    let dir = tempfile::tempdir().expect("a folder");
    let listed = run(dir.path(), ["settings", "--json"]).done().json();
    let settings = listed["settings"].as_array().expect("a list");
    let found: BTreeSet<&str> = settings.iter().filter_map(|setting| setting["name"].as_str()).collect();
    assert_eq!(found.len(), settings.len(), "each once");
    for setting in settings {
        for key in ["label", "unit", "text"] {
            assert!(setting[key].is_string(), "{key}: {setting}");
        }
        assert!(!setting["label"].as_str().unwrap_or_default().is_empty(), "{setting}");
        assert!(setting.get("range").is_some() && setting.get("default").is_some(), "{setting}");
    }
    let of = |name: &str| settings.iter().find(|setting| setting["name"] == name).expect(name).clone();
    let wind = of("simulation.wind.speed");
    assert_eq!(
        (&wind["range"], &wind["default"], &wind["unit"]),
        (&json!([0.0, 30.0]), &json!(0.0), &json!("m/s"))
    );
    assert_eq!(of("picture.transparency")["range"][0], json!("opaque"));
    assert_eq!(of("shadow.occupancy_maps.slabs")["range"], json!([4, 8, 16]));
    let section = run(dir.path(), ["settings", "simulation.wind"]);
    assert!(
        section.done().stdout.starts_with("[simulation.wind]\nsimulation.wind.speed = 0  (0 to 30 m/s)\n")
    );
    run(dir.path(), ["settings", "sparkle"]).refused(2);
}

#[test]
fn a_setting_is_changed_for_one_run() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    let before = std::fs::read(dir.path().join("p.lovelock")).expect("the project");
    let frames = ["record", "p.lovelock", "-o", "a", "--frames", "0..1", "--backend", "cpu", "--json"];
    let set = ["--set", "hair.groom.wisps=12", "--set", "recording.width=128", "--set", "shadow.method=none"];
    let ran = run(dir.path(), frames.iter().chain(&set));
    let report = ran.done().json();
    assert_eq!(
        (&report["strands"], &report["width"], &report["shadow"]),
        (&json!(96), &json!(128), &json!("none"))
    );
    assert_eq!(std::fs::read(dir.path().join("p.lovelock")).expect("the project"), before);
}

#[test]
fn wrong_settings_are_refused_with_what_is_valid() {
    let dir = tempfile::tempdir().expect("a folder");
    for (set, parts) in [
        ("look.roughness=7", vec!["look.roughness", "7", "0.05 to 1"]),
        ("look.roughnes=1", vec!["look.roughnes", "the nearest is look.roughness"]),
        ("look.roughness", vec!["look.roughness", "NAME=VALUE"]),
        ("picture.transparency=magic", vec!["magic", "weighted-average"]),
        ("shadow.exact.resolution=65", vec!["64 and 80"]),
        ("lights.7.intensity=1", vec!["lights.7.intensity", "the nearest is lights."]),
    ] {
        for command in ["record", "compare", "farm"] {
            let ran = run(dir.path(), [command, "-o", "out", "--set", set]);
            let line = ran.refused(2);
            assert!(parts.iter().all(|part| line.contains(part)), "{set}: {line}");
        }
    }
    assert!(run(dir.path(), ["--set", "look.roughness=1", "info", "x"]).refused(2).contains("after it"));
    assert_eq!(names(dir.path()), [""; 0], "nothing is written");
}
