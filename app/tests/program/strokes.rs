//! `lovelock style`.

use crate::tool::{run, saved, small_project};

/// A stroke of a wide brush through the head, at rest.
fn strokes(pressure: &str) -> String {
    let sample = |x: f32, drag: f32| {
        format!(
            "(position: ({x:?}, 1.55, 0.0), view: (0.0, 0.0, -1.0), drag: ({drag:?}, 0.0, 0.0), pressure: {pressure}, \
             time_secs: 0.0)"
        )
    };
    format!(
        "(version: 1, strokes: [(tool: comb, settings: (radius: 0.5, front_only: false), samples: [{}, {}])])",
        sample(0.0, 0.0),
        sample(0.2, 0.2)
    )
}

#[test]
fn strokes_are_written_into_a_project() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "hair.lovelock", &small_project());
    std::fs::write(dir.path().join("a.lovelockstrokes"), strokes("1.0")).expect("a file");
    let style = |project: &str, file: &str, out: &str| {
        run(dir.path(), ["style", project, "--strokes", file, "-o", out, "--json"])
    };
    let report = style("hair.lovelock", "a.lovelockstrokes", "combed.lovelock").done().json();
    assert_eq!((report["strokes"].as_u64(), report["missed"].as_u64()), (Some(1), Some(0)), "{report}");
    assert!(report["places"].as_u64() > Some(10), "{report}");
    let text = std::fs::read_to_string(dir.path().join("combed.lovelock")).expect("a project");
    assert!(text.contains("\"hand\"") && text.contains("\"edits\""));
    // Further strokes go into the same layer.
    let again = style("combed.lovelock", "a.lovelockstrokes", "more.lovelock").done().json();
    assert_eq!(again["layer"], report["layer"]);

    std::fs::write(dir.path().join("bad.lovelockstrokes"), strokes("NaN")).expect("a file");
    let refused = style("hair.lovelock", "bad.lovelockstrokes", "none.lovelock");
    let line = refused.refused(2);
    assert!(
        line.contains("bad.lovelockstrokes: stroke 0, sample 0: found what is not a finite number"),
        "{line}"
    );
    assert!(
        style("hair.lovelock", "missing.lovelockstrokes", "none.lovelock").refused(2).contains("missing")
    );
    std::fs::write(dir.path().join("text.lovelockstrokes"), "hello").expect("a file");
    let line = style("hair.lovelock", "text.lovelockstrokes", "none.lovelock").refused(2).to_owned();
    assert!(
        line.contains("text.lovelockstrokes: begins with “hello”; must be a Lovelock stroke recording"),
        "{line}"
    );
    assert!(!dir.path().join("none.lovelock").exists());
    // They are no project: their text would be one without any settings.
    let recorded = run(dir.path(), ["record", "a.lovelockstrokes", "-o", "none.mp4"]);
    assert!(recorded.refused(2).contains("a.lovelockstrokes: found recorded strokes"));
    // A project that is there is kept, whatever it is.
    let kept = std::fs::read(dir.path().join("hair.lovelock")).expect("a project");
    let line = style("combed.lovelock", "a.lovelockstrokes", "hair.lovelock").refused(2).to_owned();
    assert!(line.contains("hair.lovelock") && line.contains("--force"), "{line}");
    assert_eq!(std::fs::read(dir.path().join("hair.lovelock")).expect("a project"), kept);
}

#[test]
fn strokes_are_filmed_while_they_are_played_on_the_dance() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut project = small_project();
    (project.recording.width, project.recording.height, project.recording.fps) = (64, 48, 20.0);
    saved(dir.path(), "hair.lovelock", &project);
    std::fs::write(dir.path().join("a.lovelockstrokes"), strokes("1.0")).expect("a file");
    let film = |more: &[&str]| {
        let given = [
            "style",
            "hair.lovelock",
            "--strokes",
            "a.lovelockstrokes",
            "-o",
            "combed.lovelock",
            "--force",
            "--json",
        ];
        run(dir.path(), given.iter().chain(more).copied())
    };
    let report = film(&["--on-dance", "0.2", "--film", "combing.mp4"]).done().json();
    assert_eq!((report["strokes"].as_u64(), report["missed"].as_u64()), (Some(1), Some(0)), "{report}");
    let bytes = std::fs::read(dir.path().join("combing.mp4")).expect("a film");
    assert_eq!(&bytes[4..8], b"ftyp");

    assert!(film(&["--film", "combing.png"]).refused(2).contains(".mp4"));
    for bad in ["nan", "-1", "1e9"] {
        assert!(film(&[&format!("--on-dance={bad}")]).refused(2).contains("--on-dance"), "{bad}");
    }
}
