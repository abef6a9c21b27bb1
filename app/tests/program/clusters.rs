//! Hair drawn as clusters, and the database from which it is drawn.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::tool::{Outcome, lovelock, names, run, run_command, saved, small_project};

/// Runs the program with a cache folder of its own.
fn run_with_cache(dir: &Path, cache: &Path, args: &[&str]) -> Outcome {
    run_command(lovelock().current_dir(dir).args(args).env("XDG_CACHE_HOME", cache))
}

#[test]
fn the_database_is_built_alike_each_time_and_described() {
    let dir = tempfile::tempdir().expect("a folder");
    let first = run(dir.path(), ["satf", "build", "-o", "ä b.bin", "--json"]).done().json();
    let second = run(dir.path(), ["satf", "build", "-o", "c.bin"]);
    assert!(second.done().stdout.contains("c.bin"), "{second:?}");
    let bytes = fs::read(dir.path().join("ä b.bin")).expect("a file");
    assert_eq!(bytes, fs::read(dir.path().join("c.bin")).expect("a file"));
    assert_eq!((&first["file"], &first["bytes"]), (&"ä b.bin".into(), &(bytes.len() as u64).into()));
    assert!(first["seconds"].as_f64().is_some_and(|secs| secs > 0.0), "{first}");
    let info = run(dir.path(), ["info", "c.bin", "--json"]).done().json();
    assert_eq!((&info["kind"], &info["checksum"]), (&"hair-clusters".into(), &first["checksum"]));
    assert_eq!(names(dir.path()), ["c.bin", "ä b.bin"]);
    for (out, code) in [("no folder/d.bin", 2), (".", 2)] {
        let ran = run(dir.path(), ["satf", "build", "-o", out]);
        assert!(ran.refused(code).contains(out), "{ran:?}");
    }
}

#[test]
fn films_of_clusters_are_drawn_and_resumed_only_as_they_began_long_suite() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    let cache = dir.path().join("cache");
    let record = |out: &str, more: &[&str]| {
        let args =
            ["record", "p.lovelock", "-o", out, "--frames", "0..2", "--size", "96x64", "--backend", "cpu"];
        let args: Vec<&str> = args.iter().chain(more).copied().collect();
        run_with_cache(dir.path(), &cache, &args)
    };
    let json = record("clusters", &["--draw", "clusters", "--json"]);
    assert_eq!(json.done().json()["draw"], "clusters");
    let strands = record("strands", &["--json"]);
    assert_eq!(strands.done().json()["draw"], "strands");
    let first = |folder: &str| {
        let folder = dir.path().join(folder);
        let names = names(&folder);
        let name = names.iter().find(|name| name.starts_with("frame_")).expect("an image");
        fs::read(folder.join(name)).expect("an image")
    };
    assert!(first("clusters") != first("strands"), "another image");
    let again = record("clusters", &["--draw", "clusters", "--resume", "--json"]);
    assert_eq!(again.done().json()["frames_kept"], 2);
    let other = record("clusters", &["--draw", "strands", "--resume"]);
    assert!(other.refused(2).contains("draw"), "{other:?}");

    // A kept database that cannot be used is made again, and told once.
    let kept =
        fs::read_dir(cache.join("lovelock")).expect("a cache").next().expect("a file").expect("a file");
    fs::write(kept.path(), b"LVLKSATF and not more").expect("written");
    let told = record("told", &["--draw", "clusters", "--json"]);
    let json = told.done().json();
    assert_eq!(json["draw"], "clusters");
    assert_eq!(told.stderr.matches("was rebuilt").count(), 1, "{told:?}");
    let silent = record("silent", &["--draw", "clusters"]);
    assert!(!silent.done().stderr.contains("was rebuilt"), "{silent:?}");
}

#[test]
fn outputs_without_images_refuse_what_hair_is_drawn_as() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    for out in ["a.take", "a.usdc", "a.glb"] {
        let ran =
            run(dir.path(), ["record", "p.lovelock", "-o", out, "--frames", "0..2", "--draw", "clusters"]);
        assert!(ran.refused(2).contains("--draw"), "{ran:?}");
    }
    assert_eq!(names(dir.path()), ["p.lovelock"]);
}

#[test]
fn clusters_are_compared_by_images_alone() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = small_project();
    // Narrow strands, with which the reference converges soon.
    project.look.real_hairs *= 0.05;
    saved(dir.path(), "p.lovelock", &project);
    let args = "compare p.lovelock -o out --frame 3 --methods voxel-map --draw strands,clusters --size 64x48 --backend cpu --draws 1 --json";
    let ran = run_with_cache(dir.path(), &dir.path().join("cache"), &args.split(' ').collect::<Vec<_>>());
    let json = ran.done().json();
    let methods = json["methods"].as_array().expect("methods");
    let of = |key: &str| methods.iter().map(|method| method[key].clone()).collect::<Vec<Value>>();
    assert_eq!(of("name"), ["voxel-map strands", "voxel-map clusters"]);
    assert_eq!(of("draw"), ["strands", "clusters"]);
    let [strands, clusters] = &methods[..] else { panic!("{json}") };
    assert!(strands["transmittance"].is_object() && strands["stability"].is_object());
    for key in ["transmittance", "transmittance_common", "transmittance_at_points", "stability", "refused"] {
        assert!(clusters[key].is_null(), "{key}: {clusters}");
    }
    let flip = |method: &Value| method["flip"]["mean"].as_f64().expect("a number");
    assert!(flip(clusters) > flip(strands), "{clusters}");
    assert!(clusters["ms"]["draw"].as_f64().is_some_and(|ms| ms > 0.0));
    let csv = fs::read_to_string(dir.path().join("out/report.csv")).expect("a table");
    assert!(csv.lines().next().is_some_and(|heading| heading.contains(",draw,transparency,")), "{csv}");
    let page = fs::read_to_string(dir.path().join("out/report.html")).expect("a page");
    assert!(page.contains("· clusters") || page.contains("drawn as clusters"), "no name of the clusters");
}
