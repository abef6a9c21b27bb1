//! The sound of films, through the program.

use std::process::Command;

use lovelock_record::read_film;

use crate::tool::{names, run, saved, small_project};

#[test]
fn a_film_has_the_sound_of_its_frames() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    lovelock_testkit::click_track(&dir.path().join("clicks ü.wav"), 4);
    // Twelve frames from second 0.4 on; the click of second 0.5 of the sound is heard at second 0.6 of the dance, 0.2 s later.
    let args = [
        "record",
        "p.lovelock",
        "--sound",
        "clicks ü.wav",
        "--set",
        "sound.offset_secs=0.1",
        "--frames",
        "12..24",
        "--backend",
        "cpu",
    ];
    let film = run(dir.path(), [&args[..], &["--json", "-o", "film.mp4"]].concat());
    assert_eq!(film.done().json()["sound"], true);
    assert_eq!(read_film(&dir.path().join("film.mp4")).expect("a film").frames, 12);
    let decode = ["-v", "error", "-xerror", "-i", "film.mp4", "-map", "0:a", "-ac", "1", "-f", "s16le", "-"];
    match Command::new("ffmpeg").args(decode).current_dir(dir.path()).output() {
        Err(_) => println!("skipped: no ffmpeg on this machine"),
        Ok(output) => {
            let errors = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success() && errors.is_empty(), "{errors}");
            let samples = output.stdout.chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]]));
            let samples: Vec<i16> = samples.collect();
            assert!(samples.len().abs_diff(19_200) < 960, "{} samples of 0.4 s", samples.len());
            let click = samples.iter().position(|sample| sample.unsigned_abs() > 4000).expect("a click");
            assert!(click.abs_diff(9600) < 96, "within 2 ms of 0.2 s: {click}");
        }
    }
    // Negative control: a muted sound leaves no track.
    let muted =
        run(dir.path(), [&args[..], &["--set", "sound.muted=true", "--json", "-o", "silent.mp4"]].concat());
    assert_eq!(muted.done().json()["sound"], false);
}

#[test]
fn a_sound_that_is_none_is_refused_and_leaves_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    saved(dir.path(), "p.lovelock", &small_project());
    std::fs::write(dir.path().join("bad.wav"), b"RIFF\0\0\0\0WAVE and nothing more").expect("a file");
    for (file, word) in [("bad.wav", "bad.wav"), ("missing.ogg", "missing.ogg"), ("p.lovelock", "no sound")] {
        let args = [
            "record",
            "p.lovelock",
            "--sound",
            file,
            "--frames",
            "0..2",
            "--backend",
            "cpu",
            "-o",
            "film.mp4",
        ];
        let said = run(dir.path(), args);
        let said = said.refused(2);
        assert!(said.contains(word), "{said}");
    }
    assert_eq!(names(dir.path()), ["bad.wav", "p.lovelock"]);
}
