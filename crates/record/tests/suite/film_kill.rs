//! Processes that are killed while they write a film, and the film that is kept of their images.

use lovelock_record::{FilmQuality, FilmReader, FilmSettings, FilmWriter, is_unfinished, keep_unfinished};
use lovelock_testkit::suite;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{env, fs};

/// Environment variable with the film that the process to be killed writes.
const CHILD: &str = "LOVELOCK_TEST_FILM_CHILD";

const SETTINGS: FilmSettings = FilmSettings { width: 64, height: 48, fps: 30.0, quality: FilmQuality::Good };

fn picture(frame: u32) -> Vec<u8> {
    (0..64 * 48).flat_map(|k| [(k % 64 * 3) as u8, (frame % 250) as u8, (k / 64) as u8, 255]).collect()
}

/// Not a test of its own: the process that the test below starts and kills.
#[test]
fn a_program_that_films() {
    let Ok(film) = env::var(CHILD) else { return };
    let mut writer = FilmWriter::create(&PathBuf::from(film), SETTINGS).unwrap();
    let mut out = std::io::stdout();
    for frame in 0..100_000 {
        writer.push(&picture(frame)).unwrap();
        writeln!(out, "frame {}", frame + 1).unwrap();
        out.flush().unwrap();
        std::thread::sleep(Duration::from_millis(3));
    }
}

/// Starts the process and kills it some time after its first frame. Returns the number of frames that it had handed to the writer.
fn killed(film: &Path, after: Duration) -> u64 {
    let mut child = Command::new(env::current_exe().unwrap())
        .args(["film_kill::a_program_that_films", "--exact", "--nocapture", "--test-threads", "1"])
        .env(CHILD, film)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    let number = |line: &String| line.rsplit_once("frame ").and_then(|(_, n)| n.parse::<u64>().ok());
    let first = lines.by_ref().find_map(|line| number(&line)).unwrap();
    std::thread::sleep(after);
    child.kill().unwrap();
    child.wait().unwrap();
    lines.filter_map(|line| number(&line)).last().unwrap_or(first)
}

#[test]
fn a_film_that_is_killed_is_kept_up_to_its_last_tables() {
    let folder = tempfile::tempdir().unwrap();
    let runs = if suite::is_long() { 60 } else { 4 };
    let mut longest = 0;
    for run in 0..runs {
        let film = folder.path().join(format!("{run}.mp4"));
        let pushed = killed(&film, Duration::from_millis(run * 7919 % 1500));
        assert!(is_unfinished(&film) && !film.exists());
        let Some(kept) = keep_unfinished(&film).unwrap() else {
            assert!(pushed < 200, "{pushed} frames and no tables");
            continue;
        };
        assert!(
            kept.path == film && kept.frames <= pushed + 1 && kept.frames % 16 == 0,
            "{kept:?} of {pushed}"
        );
        let mut reader = FilmReader::open(&film).unwrap();
        let (mut frames, mut frame) = (0, Vec::new());
        while reader.next_frame(&mut frame).unwrap() {
            frames += 1;
        }
        assert_eq!(frames, kept.frames);
        assert!(!is_unfinished(&film));
        longest = longest.max(frames);
        println!("{pushed} frames were handed over, {frames} are kept");
    }
    assert!(longest >= 16, "no film was long enough to be kept");
    let left = fs::read_dir(folder.path()).unwrap().filter_map(Result::ok);
    assert!(left.filter(|entry| entry.path().extension().is_some_and(|end| end == "tables")).count() <= 1);
}
