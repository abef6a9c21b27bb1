//! Wrong requests end with exit status 2 and one line that names what is wrong, and write nothing.

use crate::tool::{names, run, saved, small_project};

#[test]
fn wrong_options_are_rejected_in_one_line() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    std::fs::create_dir(dir.path().join("folder")).expect("a folder");
    let before = names(dir.path());
    let film = ["record", "-o", "a.mp4"];
    let with = |more: &[&'static str]| -> Vec<&'static str> { film.iter().chain(more).copied().collect() };
    let wrong: Vec<(Vec<&str>, &str)> = vec![
        (with(&["--shadow", "magic"]), "magic"),
        (with(&["--shadow", "magic"]), "voxel-map"),
        (with(&["--transparency", "magic"]), "magic"),
        (with(&["--draw", "magic"]), "clusters"),
        (with(&["--backend", "magic"]), "cpu"),
        (with(&["--preset", "curley"]), "`curly`"),
        (with(&["--preset", "no such.lovelockstyle"]), "no such.lovelockstyle"),
        (vec!["presets", "--preset", "curley"], "`curly`"),
        (vec!["presets", "--dance", "3"], "--sheet"),
        (vec!["presets", "--sheet", "a.png", "--size", "9000x9000"], "32768"),
        (with(&["--frames", "5..5"]), "5..5"),
        (with(&["--frames", "9..3"]), "9..3"),
        (with(&["--frames", "ten"]), "ten"),
        (with(&["--frames", "0..99999999999999999999"]), "--frames"),
        (with(&["--frames=-4..4"]), "-4..4"),
        (with(&["--fps", "0"]), "0"),
        (with(&["--fps", "nan"]), "nan"),
        (with(&["--fps", "1e9"]), "1e9"),
        (with(&["--size", "1280"]), "1280"),
        (with(&["--size", "0x64"]), "0x64"),
        (with(&["--size", "96x-64"]), "96x-64"),
        (with(&["--size", "95x64"]), "95x64"),
        (with(&["--size", "96x63"]), "96x63"),
        (with(&["--size", "100000x100000"]), "100000x100000"),
        (with(&["no such project.lovelock"]), "no such project.lovelock"),
        (with(&["folder"]), "folder"),
        (with(&["--hair", "no such.hair"]), "no such.hair"),
        (with(&["--body", "no such.glb"]), "no such.glb"),
        (with(&["--motion", "no such.bvh"]), "no such.bvh"),
        (with(&["--preset", "curly", "--hair", "x.hair"]), "--hair"),
        (with(&["--sparkle"]), "--sparkle"),
        (vec!["record", "-o", "a.gif"], "a.gif"),
        (vec!["record", "-o", ""], ""),
        (vec!["record"], "--out"),
        (vec!["p.lovelock", "record", "-o", "a.mp4"], "p.lovelock"),
        (vec!["sparkle", "twice"], "twice"),
        (vec!["no such project.lovelock", "--screenshot", "a.png"], "no such project.lovelock"),
        (vec!["info"], "FILE"),
        (vec!["satf", "build"], "--out"),
        (vec!["info", "no such.hair"], "no such.hair"),
        (vec!["info", "folder"], "folder"),
    ];
    for (args, named) in wrong {
        for json in [false, true] {
            let mut args = args.clone();
            if json {
                args.push("--json");
            }
            let ran = run(dir.path(), &args);
            let line = ran.refused(2);
            assert!(line.contains(named), "{args:?}: `{named}` is missing: {line}");
            if json {
                let error = &ran.json()["error"];
                assert!(error["message"].as_str().is_some_and(|m| line.contains(m)), "{args:?}: {error}");
                assert!(error.as_object().is_some_and(|error| error.contains_key("file")), "{args:?}");
            } else {
                assert_eq!(ran.stdout, "", "{args:?}");
            }
        }
    }
    assert_eq!(names(dir.path()), before, "something was written");
}

#[test]
fn an_error_in_json_names_its_file() {
    let dir = tempfile::tempdir().expect("a folder");
    let ran = run(dir.path(), ["info", "--json", "ü no.hair"]);
    ran.refused(2);
    assert_eq!(ran.json()["error"]["file"], "ü no.hair");
    let ran = run(dir.path(), ["record", "--json", "-o", "a.mp4", "--fps", "0"]);
    ran.refused(2);
    assert!(ran.json()["error"]["file"].is_null());
}

#[test]
fn help_and_version_succeed() {
    let dir = tempfile::tempdir().expect("a folder");
    for args in [&["--help"][..], &["--version"], &["record", "--help"], &["help", "info"]] {
        let ran = run(dir.path(), args);
        assert!(!ran.done().stdout.is_empty() && ran.stderr.is_empty(), "{ran:?}");
    }
}

#[test]
fn a_window_without_a_display_is_an_error() {
    let dir = tempfile::tempdir().expect("a folder");
    // macOS and Windows need no environment variable to open a window, so the program would not exit there.
    if cfg!(all(unix, not(target_os = "macos"))) {
        let ran = run(dir.path(), Vec::<&str>::new());
        let line = ran.refused(1);
        assert!(
            line.contains("lovelock record"),
            "the command that works without a display is missing: {line}"
        );
        // The window would tell it. Without one, the file is the error of the command.
        let ran = run(dir.path(), ["no such project.lovelock"]);
        assert!(ran.refused(2).contains("no such project.lovelock"), "{ran:?}");
    }
}

#[test]
fn files_that_hold_work_or_are_not_ours_are_kept_without_force() {
    let dir = tempfile::tempdir().expect("a folder");
    for folder in ["frames", "report", "small"] {
        std::fs::create_dir(dir.path().join(folder)).expect("a folder");
    }
    let mine = [
        "x.take",
        "film.mp4",
        "hair.tfx",
        "sheet.png",
        "frames/frame_000001.png",
        "c.usda",
        "report/report.csv",
        "small/bob.jpg",
        "times.csv",
        "db.bin",
    ];
    for name in mine {
        std::fs::write(dir.path().join(name), b"mine").expect("a file");
    }
    std::fs::write(dir.path().join("in.hair"), b"x").expect("a file");
    for args in [
        &["record", "-o", "x.take"][..],
        &["record", "-o", "film.mp4"],
        &["record", "-o", "frames"],
        &["record", "-o", "c.usda"],
        &["convert", "in.hair", "hair.tfx"],
        &["presets", "--preset", "bob", "--sheet", "sheet.png"],
        &["presets", "--preset", "bob", "--thumbnails", "small"],
        &["compare", "-o", "report"],
        &["bench", "-o", "times.csv"],
        &["satf", "build", "-o", "db.bin"],
        &["--screenshot", "sheet.png"],
    ] {
        let line = run(dir.path(), args.iter().copied()).refused(2).to_owned();
        let out = args.last().expect("an output");
        assert!(line.contains(out) && line.contains("--force"), "{args:?}: {line}");
    }
    for name in mine {
        assert_eq!(std::fs::read(dir.path().join(name)).expect("a file"), b"mine", "{name}");
    }
}
