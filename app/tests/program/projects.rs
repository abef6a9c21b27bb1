//! Project files that are broken, too large, or written by another version.

use std::fs::File;
use std::path::Path;

use crate::tool::{names, run, saved, small_project};

/// Checks that every command that reads a project rejects the file in one line that names it.
#[track_caller]
fn assert_rejected_everywhere(folder: &Path, name: &str, says: &str) {
    let before = names(folder);
    for args in [vec!["info", name], vec!["record", name, "-o", "a.mp4", "--frames", "0..1"], vec![name]] {
        let ran = run(folder, &args);
        let line = ran.refused(2);
        assert!(line.contains(name) && line.contains(says), "{args:?}: {line}");
        assert_eq!(ran.stdout, "");
    }
    assert_eq!(names(folder), before);
}

#[test]
fn files_that_are_not_projects_are_rejected() {
    let dir = tempfile::tempdir().expect("a folder");
    let write = |name: &str, bytes: &[u8]| std::fs::write(dir.path().join(name), bytes).expect("a file");
    write("empty.lovelock", b"");
    assert_rejected_everywhere(dir.path(), "empty.lovelock", "is empty");

    write("newer.lovelock", b"(version: 99, sparkle: Yes(3))");
    assert_rejected_everywhere(dir.path(), "newer.lovelock", "newer");

    // Pseudo-random bytes, which are not text in any encoding.
    let mut state = 1_u32;
    let noise: Vec<u8> = (0..4096)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .collect();
    write("noise.lovelock", &noise);
    assert_rejected_everywhere(dir.path(), "noise.lovelock", "byte");

    write("deep.lovelock", format!("(version: 1, hair: {}", "(".repeat(100_000)).as_bytes());
    assert_rejected_everywhere(dir.path(), "deep.lovelock", "line 1");

    write("words.lovelock", b"(version: 1, lights: \"many\")");
    assert_rejected_everywhere(dir.path(), "words.lovelock", "line 1");

    let whole = std::fs::read(saved(dir.path(), "whole.lovelock", &small_project())).expect("the file");
    write("cut ü.lovelock", &whole[..whole.len() / 2]);
    assert_rejected_everywhere(dir.path(), "cut ü.lovelock", "line");
}

#[test]
fn a_huge_file_is_rejected_without_being_read() {
    let dir = tempfile::tempdir().expect("a folder");
    // A sparse file, which takes no space on the disk.
    let file = File::create(dir.path().join("huge.lovelock")).expect("a file");
    if file.set_len(1 << 36).is_err() {
        eprintln!("skipped: no sparse files here");
        return;
    }
    assert_rejected_everywhere(dir.path(), "huge.lovelock", "bytes");
}

#[test]
fn unknown_fields_and_values_out_of_range_are_reported() {
    let dir = tempfile::tempdir().expect("a folder");
    let text = "(version: 1, sparkle: 3, recording: (width: 96, glitter: true, fps: 1000.0))";
    std::fs::write(dir.path().join("p.lovelock"), text).expect("a file");
    let ran = run(dir.path(), ["info", "p.lovelock", "--json"]);
    let json = ran.done().json();
    assert_eq!(
        (&json["kind"], &json["hair"], &json["width"]),
        (&"project".into(), &"smooth".into(), &96.into())
    );
    assert_eq!(json["fps"], 240.0, "not clamped to its range");
    assert_eq!(json["dropped"].as_object().and_then(|d| d.values().next()), Some(&2.into()), "{json}");
    let notes = json["notes"].to_string();
    for word in ["sparkle", "glitter", "fps"] {
        assert!(notes.contains(word), "{word}: {notes}");
    }
}
