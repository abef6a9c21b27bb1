//! `lovelock record`: EXR files, motion blur, and recordings that were interrupted.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use lovelock_testkit::wait::{wait_for, wait_until};

use crate::tool::{lovelock, names, run, run_command, saved, small_project};

/// A folder with a small project.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    dir
}

/// The start of every command line in these tests.
const RECORD: [&str; 6] = ["record", "p.lovelock", "--backend", "cpu", "--json", "-o"];

fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    names(folder)
        .into_iter()
        .map(|name| (name.clone(), std::fs::read(folder.join(name)).expect("a file")))
        .collect()
}

#[test]
fn format_blur_and_transparency_are_in_the_json() {
    let dir = folder();
    let more = [
        "x",
        "--frames",
        "3..5",
        "--format",
        "exr",
        "--transparent",
        "--motion-blur",
        "3",
        "--shutter",
        "90",
    ];
    let json = run(dir.path(), RECORD.iter().chain(&more)).done().json();
    assert_eq!((&json["format"], &json["transparent"]), (&"exr".into(), &true.into()));
    assert_eq!((&json["motion_blur"], &json["shutter_degrees"]), (&3.into(), &90.0.into()));
    assert_eq!((&json["frames"], &json["frames_kept"]), (&2.into(), &0.into()));
    assert_eq!(names(&dir.path().join("x")), ["frame_000003.exr", "frame_000004.exr", "manifest.json"]);
    // The magic number of OpenEXR.
    let bytes = std::fs::read(dir.path().join("x/frame_000003.exr")).expect("a file");
    assert_eq!(bytes[..4], [0x76, 0x2f, 0x31, 0x01]);
    let film = run(dir.path(), RECORD.iter().chain(&["a.mp4", "--frames", "0..1", "--transparent"]));
    assert!(film.refused(2).contains("no alpha"), "{film:?}");
    for (option, value) in
        [("--motion-blur", "65"), ("--shutter", "-1"), ("--shutter", "nan"), ("--format", "tiff")]
    {
        let ran = run(dir.path(), RECORD.iter().chain(&["y", option, value]));
        assert_eq!(ran.code, Some(2), "{ran:?}");
        assert!(ran.stderr.contains(value), "{ran:?}");
    }
    assert!(!dir.path().join("y").exists());
}

#[test]
fn a_killed_recording_resumes_to_the_same_bytes_long_suite() {
    let dir = folder();
    let more =
        |out: &'static str| [out, "--frames", "0..16", "--size", "96x64", "--motion-blur", "2", "--resume"];
    run(dir.path(), RECORD.iter().chain(&more("whole"))).done();
    let parts = dir.path().join("parts");
    let pictures = |folder: &Path| {
        let all = std::fs::read_dir(folder).into_iter().flatten().flatten();
        all.filter(|entry| entry.path().extension().is_some_and(|ending| ending == "png")).count()
    };
    // Where this test gets no time while the program does, the program may end first; then it starts again.
    wait_until("a recording that is killed before its end", || {
        let _ = std::fs::remove_dir_all(&parts);
        let mut child = begun(dir.path(), &more("parts"));
        wait_until("some images", || pictures(&parts) > 2 || child.try_wait().expect("its state").is_some());
        let _ = child.kill();
        !child.wait().expect("gone").success()
    });
    assert!(!parts.join("manifest.json").exists(), "the manifest of an unfinished sequence exists");
    let there = pictures(&parts);
    let json = run(dir.path(), RECORD.iter().chain(&more("parts"))).done().json();
    let kept = json["frames_kept"].as_u64().expect("a number");
    println!("{there} images existed, {kept} were kept");
    assert!(kept >= 1 && kept as usize <= there, "{kept} of {there}");
    assert!(contents(&parts) == contents(&dir.path().join("whole")), "the bytes differ");
    let mut other = small_project();
    other.look.roughness += 0.1;
    saved(dir.path(), "p.lovelock", &other);
    let refused = run(dir.path(), RECORD.iter().chain(&more("parts")));
    assert!(refused.refused(2).contains("look changed"), "{refused:?}");
}

/// A recording that has been started.
fn begun(folder: &Path, more: &[&str]) -> Child {
    let mut command = lovelock();
    command.current_dir(folder).args(RECORD.iter().chain(more)).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("the program starts")
}

/// Sends a signal to a program.
#[cfg(unix)]
fn signal(to: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &to.id().to_string()]).status();
    assert!(sent.expect("`kill` starts").success(), "{name}");
}

#[cfg(unix)]
#[test]
fn a_second_recording_to_the_same_output_is_rejected() {
    let dir = folder();
    for (out, finished) in [("one", "one/manifest.json"), ("one.mp4", "one.mp4")] {
        let more = [out, "--frames", "0..24", "--size", "96x64"];
        let part = ["one/frame_000000.png", "one.mp4.partial"].map(|name| dir.path().join(name));
        // The first stands still until the second has answered. If it ends before it is stopped, it starts again.
        let output = dir.path().join(out);
        let mut first = wait_for("a recording that is stopped before its end", || {
            // What a recording has left that ended before it was stopped.
            let _ = std::fs::remove_dir_all(&output);
            let _ = std::fs::remove_file(&output);
            let mut first = begun(dir.path(), &more);
            wait_until("its output", || {
                part[usize::from(out == "one.mp4")].exists() || first.try_wait().expect("its state").is_some()
            });
            signal(&first, "-STOP");
            if dir.path().join(finished).exists() {
                let _ = first.kill();
                first.wait().expect("gone");
                return None;
            }
            Some(first)
        });
        let second = run(dir.path(), RECORD.iter().chain(&more));
        signal(&first, "-CONT");
        assert!(second.refused(1).contains("another recording is writing"), "{second:?}");
        assert!(first.wait().expect("its end").success());
        assert!(dir.path().join(finished).exists());
    }
    assert_eq!(names(&dir.path().join("one")).len(), 25);
}

/// A shell's limit on file sizes stands for a full disk: the system rejects a write in the same way.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_a_recording_with_an_error_and_leaves_no_output() {
    let dir = folder();
    for (out, more) in [("a.mp4", ""), ("a.apng", ""), ("a", ""), ("e", "--format exr")] {
        let program = env!("CARGO_BIN_EXE_lovelock");
        let script = format!(
            "trap '' XFSZ; ulimit -f 8; exec {program} record p.lovelock --backend cpu --size 240x180 --frames 0..9 -o {out} {more}"
        );
        let mut command = std::process::Command::new("sh");
        let ran = run_command(command.current_dir(dir.path()).args(["-c", &script]).env_remove("DISPLAY"));
        assert_eq!(ran.code, Some(1), "{out}: {ran:?}");
        let last = ran.stderr.lines().last().unwrap_or_default();
        assert!(last.contains(out) && last.contains("could not"), "{out}: {ran:?}");
        assert!(!ran.stderr.contains("panicked"), "{ran:?}");
    }
    let left = names(dir.path());
    assert_eq!(left, ["p.lovelock"], "unfinished files are left");
}

#[test]
fn frames_outside_a_take_are_rejected_with_its_range() {
    let dir = folder();
    run(dir.path(), ["record", "p.lovelock", "-o", "d.take", "--frames", "0..12", "--json"]).done();
    for wrong in ["0..99", "90..95"] {
        let ran = run(dir.path(), ["record", "d.take", "-o", "x", "--frames", wrong, "--backend", "cpu"]);
        let said = ran.refused(2);
        assert!(said.contains(wrong) && said.contains("d.take") && said.contains("frames 0.."), "{said}");
    }
    assert!(!dir.path().join("x").exists());
    // Samples after the last frame show the last frame.
    let more =
        ["record", "d.take", "-o", "x", "--frames", "11..12", "--motion-blur", "4", "--shutter", "360"];
    run(dir.path(), more.iter().chain(&["--backend", "cpu", "--json"])).done();
}
