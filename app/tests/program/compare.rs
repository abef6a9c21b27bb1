//! `lovelock compare`.

use std::path::Path;

use lovelock_render::ShadowMethod;
use serde_json::Value;

use crate::tool::{names, run, saved, small_project};

#[test]
fn a_report_has_the_documented_keys_and_files() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = small_project();
    // Makes strands narrower to the light: the reference takes long to converge with wide ones.
    project.look.real_hairs *= 0.05;
    saved(dir.path(), "ein Projekt ü.lovelock", &project);
    let ran = run(
        dir.path(),
        [
            "compare",
            "ein Projekt ü.lovelock",
            "-o",
            "reports/größe & ü",
            "--frame",
            "3",
            "--methods",
            "none,voxel-map,exact",
            "--size",
            "48x32",
            "--backend",
            "cpu",
            "--json",
        ],
    );
    let json = ran.done().json();
    assert_eq!(json["frames"], serde_json::json!([3, 4]));
    assert_eq!(json["complete"], Value::Bool(true));
    assert!(json["reference"]["converged"].is_boolean() && json["reference"]["samples"].is_u64());
    let methods = json["methods"].as_array().expect("methods");
    let ids: Vec<_> = methods.iter().map(|method| method["id"].as_str().unwrap_or_default()).collect();
    assert_eq!(ids, ["none", "voxel-map", "exact"]);
    for method in methods {
        for key in ["draw", "transparency", "backend", "adapter", "memory_bytes", "ssim"] {
            assert!(!method[key].is_null(), "no `{key}` in {method}");
        }
        for key in ["rmse", "bias", "p99", "first10_rmse"] {
            assert!(method["transmittance"][key].is_number(), "no `{key}` in {method}");
        }
        for key in ["mean", "p99"] {
            assert!(method["flip"][key].is_number(), "no `{key}` in {method}");
        }
        for key in ["build", "query", "draw"] {
            assert!(method["ms"][key].is_number(), "no `{key}` in {method}");
        }
        // The default number of draws.
        assert_eq!(method["times"][0]["count"], Value::from(30));
    }
    let out = dir.path().join("reports/größe & ü");
    assert_eq!(names(&out), ["pictures", "report.csv", "report.html", "report.json"]);
    let pictures = names(&out.join("pictures"));
    for file in ["reference.png", "voxel-map.png", "exact.transmittance-error.png", "none.picture-error.png"]
    {
        assert!(pictures.iter().any(|name| name == file), "no {file} in {pictures:?}");
    }
    assert!(
        pictures.iter().all(|name| Path::new(name).extension().is_some_and(|end| end == "png")),
        "{pictures:?}"
    );
}

#[test]
fn wrong_requests_are_rejected_in_one_line_without_output() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    std::fs::write(dir.path().join("file"), b"x").expect("a file");
    let before = names(dir.path());
    let wrong: [(&[&str], &str, i32); 21] = [
        (&["--methods", "magic"], "magic", 2),
        (&["--methods", "voxel-map,"], "density-clustering", 2),
        (&["--transparency", "magic"], "weighted-average", 2),
        (&["--draw", "strands,magic"], "auto", 2),
        (&["--backend", "magic"], "both", 2),
        (&["--frame", "1000000"], "1000000", 2),
        (&["--frame", "18446744073709551614"], "18446744073709551614 is outside the clip", 2),
        (&["--frame", "18446744073709551615"], "found 18446744073709551615; must be inside the clip", 2),
        (&["--frames", "5..5"], "5..5", 2),
        (&["--frame", "1", "--frames", "1..2"], "--frame", 2),
        (&["--size", "9x"], "9x", 2),
        (&["--sweep", "resolution"], "resolution", 2),
        (&["--sweep", "resolution=1"], "64 to 4096", 2),
        (&["--sweep", "resolution=64,65"], "64 and 80", 2),
        (&["--sweep", "sparkle=1"], "slabs", 2),
        (&["--probe", "5"], "5", 2),
        (&["--probe", "96,0"], "96,0", 2),
        (&["--draws", "0"], "1..=1000", 2),
        (&["--hair", "no such.hair"], "no such.hair", 2),
        (&["-o", "file"], "file", 2),
        (&["-o", "file/in it"], "in it", 1),
    ];
    for (more, named, code) in wrong {
        let mut args = vec!["compare", "p.lovelock", "--size", "96x64", "--backend", "cpu"];
        // An option given twice would be rejected for that reason instead.
        if more[0] == "--size" {
            args.drain(2..4);
        }
        if more[0] == "--backend" {
            args.truncate(4);
        }
        if more[0] == "--sweep" {
            args.extend(["--methods", "occupancy-maps"]);
        }
        if more[0] != "-o" {
            args.extend(["-o", "report"]);
        }
        args.extend(more);
        let ran = run(dir.path(), &args);
        let line = ran.refused(code);
        assert!(line.contains(named), "{args:?}: `{named}` is missing: {line}");
        assert_eq!(names(dir.path()), before, "{args:?}");
    }
    let ran = run(dir.path(), ["compare", "p.lovelock", "-o", "report", "--methods", "fog"]);
    for method in ShadowMethod::ALL {
        assert!(ran.refused(2).contains(method.id()), "{}", ran.stderr);
    }
}

#[test]
fn a_quick_comparison_leaves_out_stability_and_names_its_steps() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = small_project();
    project.look.real_hairs *= 0.05;
    saved(dir.path(), "p.lovelock", &project);
    let args = "compare p.lovelock -o out --frame 3 --methods none,voxel-map --size 48x32 --backend cpu --quick --json";
    let ran = run(dir.path(), args.split(' '));
    let json = ran.done().json();
    let notes = json["notes"].to_string();
    assert!(notes.contains("quick comparison") && notes.contains("only 5 draws"), "{notes}");
    for method in json["methods"].as_array().expect("methods") {
        assert_eq!(method["times"][0]["count"], Value::from(5));
        assert!(method["flip"]["mean"].is_number() && method["transmittance"]["rmse"].is_number());
        for key in ["stability", "light_sweep", "stray", "banding"] {
            assert!(method[key].is_null(), "{key} in {method}");
        }
    }
    // Two ground truths, that at points, the images, the probes, and two methods.
    for step in ["ground truth for none (1 of 7)", "ground truth at points (3 of 7", "voxel-map (7 of 7"] {
        assert!(ran.stderr.lines().any(|line| line.starts_with(step)), "{step}: {}", ran.stderr);
    }
    let last = ran.stderr.lines().find(|line| line.starts_with("voxel-map (7")).unwrap_or_default();
    assert!(last.contains("about") && last.ends_with("left)"), "an estimate: {last}");
}
