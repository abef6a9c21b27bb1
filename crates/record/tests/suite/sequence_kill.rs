//! Processes that are killed while they write a sequence, and the recordings that resume it.

use lovelock_record::{SequenceFormat, SequenceSettings, SequenceWriter, read_manifest};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{env, fs};

/// Environment variable with the folder that the process to be killed writes to.
const CHILD: &str = "LOVELOCK_TEST_SEQUENCE_CHILD";

const FRAMES: u32 = 400;
const SIDE: u32 = 96;

fn picture(frame: u32) -> Vec<u8> {
    let noise = |i: u32| (i ^ frame).wrapping_mul(2_654_435_761).to_le_bytes()[2];
    (0..SIDE * SIDE * 4).map(noise).collect()
}

/// Most frames that the process to be killed writes; then it waits for its end, so that it has one on every machine.
const MAX_OF_A_PROCESS: u32 = 70;

/// Writes the missing frames and calls `told` with the number of each.
fn write(folder: &Path, told: &mut dyn FnMut(u32)) -> u32 {
    let settings = SequenceSettings {
        width: SIDE,
        height: SIDE,
        fps: 30.0,
        first_frame: 0,
        format: SequenceFormat::Png,
        alpha: true,
        resume: true,
        settings: serde_json::json!({ "shadow": "none" }),
    };
    let mut writer = SequenceWriter::create(folder, settings).unwrap();
    let mut drawn = 0;
    for frame in 0..FRAMES {
        if writer.next_is_kept() {
            writer.keep_next();
        } else {
            writer.push(&picture(frame)).unwrap();
            drawn += 1;
            told(frame);
        }
    }
    writer.finish().unwrap();
    drawn
}

/// Not a test of its own: the process that the test below starts and kills.
#[test]
fn a_program_that_writes() {
    let Ok(folder) = env::var(CHILD) else { return };
    let mut out = std::io::stdout();
    let mut written = 0;
    write(&PathBuf::from(folder), &mut |frame| {
        writeln!(out, "frame {frame}").unwrap();
        out.flush().unwrap();
        written += 1;
        if written == MAX_OF_A_PROCESS {
            loop {
                std::thread::park();
            }
        }
    });
}

fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap()))
        .collect();
    all.sort();
    all
}

#[test]
fn a_sequence_that_was_killed_again_and_again_is_that_of_one_run() {
    if env::var(CHILD).is_ok() {
        return;
    }
    let (whole, folder) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    assert_eq!(write(whole.path(), &mut |_| ()), FRAMES);
    let wanted = contents(whole.path());
    for (frames, more) in [(1, 0), (20, 3), (40, 1), (60, 7), (30, 2)] {
        let mut child = Command::new(env::current_exe().unwrap())
            .args(["sequence_kill::a_program_that_writes", "--exact", "--nocapture", "--test-threads", "1"])
            .env(CHILD, folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // The pipe stays open until the process is killed: a process that cannot write to it would end by itself, and tidy up.
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        lines.by_ref().filter(|line| line.starts_with("frame ")).take(frames).for_each(drop);
        std::thread::sleep(Duration::from_millis(more));
        child.kill().unwrap();
        child.wait().unwrap();
        // A frame with its final name is complete at any moment.
        let is_frame = |name: &str| Path::new(name).extension().is_some_and(|ending| ending == "png");
        for (name, bytes) in contents(folder.path()).into_iter().filter(|(name, _)| is_frame(name)) {
            let same = wanted.binary_search_by(|(other, _)| other.cmp(&name)).map(|at| wanted[at].1 == bytes);
            assert_eq!(same, Ok(true), "{name} is incomplete");
        }
        assert!(read_manifest(folder.path()).is_err(), "no manifest of a finished sequence");
    }
    let drawn = write(folder.path(), &mut |_| ());
    // About 150 were written before. Frames that were being written when a process was killed are written again.
    assert!(drawn > 0 && drawn < FRAMES - 80, "{drawn} of {FRAMES} were written at the end");
    assert!(contents(folder.path()) == wanted, "byte for byte");
}
