//! Project files that are not what they should be.

use std::fs::File;
use std::path::Path;

use crate::tool::{names, run, saved, small_project};

/// Every way into the program that reads a project must refuse the file in one line that names it.
#[track_caller]
fn refused_everywhere(folder: &Path, name: &str, says: &str) {
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
fn files_that_are_no_projects_are_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let write = |name: &str, bytes: &[u8]| std::fs::write(dir.path().join(name), bytes).expect("a file");
    write("empty.lovelock", b"");
    refused_everywhere(dir.path(), "empty.lovelock", "line 1");

    write("newer.lovelock", b"(version: 99, sparkle: Yes(3))");
    refused_everywhere(dir.path(), "newer.lovelock", "newer");

    // Bytes of a linear congruence: no text in any encoding.
    let mut state = 1_u32;
    let noise: Vec<u8> = (0..4096)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .collect();
    write("noise.lovelock", &noise);
    refused_everywhere(dir.path(), "noise.lovelock", "byte");

    write("deep.lovelock", format!("(version: 1, hair: {}", "(".repeat(100_000)).as_bytes());
    refused_everywhere(dir.path(), "deep.lovelock", "line 1");

    write("words.lovelock", b"(version: 1, lights: \"many\")");
    refused_everywhere(dir.path(), "words.lovelock", "line 1");

    let whole = std::fs::read(saved(dir.path(), "whole.lovelock", &small_project())).expect("the file");
    write("cut ü.lovelock", &whole[..whole.len() / 2]);
    refused_everywhere(dir.path(), "cut ü.lovelock", "line");
}

#[test]
fn a_huge_file_is_refused_without_being_read() {
    let dir = tempfile::tempdir().expect("a folder");
    // Takes no room on the disk: all of it is a hole.
    let file = File::create(dir.path().join("huge.lovelock")).expect("a file");
    if file.set_len(1 << 36).is_err() {
        eprintln!("skipped: no sparse files here");
        return;
    }
    refused_everywhere(dir.path(), "huge.lovelock", "bytes");
}

#[test]
fn a_project_with_fields_of_others_opens_and_says_so() {
    let dir = tempfile::tempdir().expect("a folder");
    let text = "(version: 1, sparkle: 3, recording: (width: 96, glitter: true, fps: 1000.0))";
    std::fs::write(dir.path().join("p.lovelock"), text).expect("a file");
    let ran = run(dir.path(), ["info", "p.lovelock", "--json"]);
    let json = ran.done().json();
    assert_eq!(
        (&json["kind"], &json["hair"], &json["width"]),
        (&"project".into(), &"smooth".into(), &96.into())
    );
    assert_eq!(json["fps"], 240.0, "brought into its range");
    assert_eq!(json["dropped"].as_object().and_then(|d| d.values().next()), Some(&2.into()), "{json}");
    let notes = json["notes"].to_string();
    for word in ["sparkle", "glitter", "fps"] {
        assert!(notes.contains(word), "{word}: {notes}");
    }
}
