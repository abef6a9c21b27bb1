//! Processes that are killed while they record a take, and two writers of one take.

use crate::take_scene::{Random, Size, frame, header, play_all, project, record};
use lovelock_record::{TakeCondition, TakeError, TakeReader, TakeWriter};
use lovelock_testkit::suite;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{env, fs};

const SIZE: Size = Size(30, 10);

/// Environment variable with the path and the number of frames for the process to be killed.
const CHILD: &str = "LOVELOCK_TEST_TAKE_CHILD";

/// Frames of a recording that never ends: it stops when nobody reads what it prints. And of one that may reach its end.
const LONG: u64 = u64::MAX;
const SHORT: u64 = 150;

/// Not a test of its own: the process that the test below starts and kills. It prints how many frames are kept.
#[test]
fn a_program_that_records() {
    let Ok(told) = env::var(CHILD) else { return };
    let (frames, path) = told.split_once(' ').unwrap();
    let (frames, path) = (frames.parse::<u64>().unwrap(), PathBuf::from(path));
    let mut writer = TakeWriter::create(&path, header(SIZE)).unwrap();
    let mut out = std::io::stdout();
    for n in 0..frames {
        writer.change(&project(n)).unwrap();
        writer.push(&frame(n, SIZE)).unwrap();
        if n % 30 == 29 {
            // A real recording takes a second per chunk; this one waits for the disk.
            while writer.kept_frames() <= n {
                std::thread::yield_now();
            }
            writeln!(out, "kept {}", n + 1).unwrap();
            out.flush().unwrap();
        }
    }
    writer.finish().unwrap();
}

/// Starts the process and kills it `after` it has reported the first frames as kept and then `chunks` more times. Returns the number of
/// frames that it reported as kept.
fn killed(path: &Path, frames: u64, chunks: usize, after: Duration) -> u64 {
    let mut child = Command::new(env::current_exe().unwrap())
        .args(["take_kill::a_program_that_records", "--exact", "--nocapture", "--test-threads", "1"])
        .env(CHILD, format!("{frames} {}", path.display()))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    let kept = |line: &String| line.strip_prefix("kept ").and_then(|n| n.parse::<u64>().ok());
    let seen = lines.by_ref().filter_map(|line| kept(&line)).take(1 + chunks).last().unwrap();
    std::thread::sleep(after);
    child.kill().unwrap();
    child.wait().unwrap();
    // What it printed until then is still in the pipe. An incomplete line does not count.
    lines.filter_map(|line| kept(&line)).last().unwrap_or(seen)
}

#[test]
fn a_recording_that_is_killed_plays_up_to_its_last_second() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(11);
    let (mut finished, mut longest) = (0, 0);
    let runs = if suite::is_long() { 100 } else { 24 };
    for run in 0..runs {
        let path = folder.path().join(format!("{run}.take"));
        let part = folder.path().join(format!("{run}.take.part"));
        let frames = if run % 4 == 0 { SHORT } else { LONG };
        let kept = killed(&path, frames, random.below(6), Duration::from_micros(random.below(10_000) as u64));
        if path.exists() {
            // The process had finished.
            assert!(frames == SHORT && !part.exists());
            let mut take = TakeReader::open(&path).unwrap();
            assert!(take.condition().is_whole());
            assert_eq!(play_all(&mut take, SIZE), SHORT);
            finished += 1;
            continue;
        }
        let mut take = TakeReader::open(&part).unwrap();
        let condition = take.condition();
        // If it was killed between the last byte and the renaming, it is complete.
        let all_but_named = condition.is_whole() && frames == SHORT && take.frames() == SHORT;
        assert!(all_but_named || matches!(condition, TakeCondition::Cut { .. }), "{run}: {condition}");
        // No frame that was reported as kept is lost, and at most the next chunks can have followed before the report.
        let played = play_all(&mut take, SIZE);
        assert!(played >= kept && played <= kept + 60, "{run}: {kept} were kept, {played} play");
        longest = longest.max(played);
        let kept = lovelock_record::keep_unfinished(&path).unwrap().unwrap();
        assert_eq!((kept.path.as_path(), kept.frames), (path.as_path(), played));
        assert_eq!(TakeReader::open(&path).unwrap().frames(), played);
        assert!(!part.exists());
    }
    // Negative control: most were killed before their end.
    println!(
        "{finished} of {} finished; the longest of the others was killed after frame {longest}",
        runs / 4
    );
    assert!(longest > 120, "no run was killed late");
}

#[test]
fn two_writers_do_not_share_a_take() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dance.take");
    record(&path, 70, SIZE);
    let mut first = TakeWriter::create(&path, header(SIZE)).unwrap();
    let error = TakeWriter::create(&path, header(SIZE)).err().unwrap();
    assert!(matches!(error, TakeError::Busy { .. }), "{error}");
    assert!(error.to_string().contains("dance.take.part"), "{error}");
    for n in 0..100 {
        first.push(&frame(n, SIZE)).unwrap();
    }
    // The existing take stays until the new one is complete.
    assert_eq!(TakeReader::open(&path).unwrap().frames(), 70);
    assert_eq!(first.finish().unwrap().frames, 100);
    assert_eq!(TakeReader::open(&path).unwrap().frames(), 100);
    // Negative control: a finished writer does not block another.
    TakeWriter::create(&path, header(SIZE)).unwrap().discard().unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn unfinished_takes_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dance.take");
    for frames in [30, 90] {
        let mut writer = TakeWriter::create(&path, header(SIZE)).unwrap();
        (0..frames).for_each(|n| writer.push(&frame(n, SIZE)).unwrap());
    }
    record(&path, 10, SIZE);
    let mut names: Vec<_> =
        fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["dance-cut1.take.part", "dance-cut2.take.part", "dance.take"]);
    for (name, frames) in [("dance-cut1.take.part", 30), ("dance-cut2.take.part", 90)] {
        let mut take = TakeReader::open(&folder.path().join(name)).unwrap();
        assert!(matches!(take.condition(), TakeCondition::Cut { .. }));
        assert!((0..frames).all(|n| take.frame(n).is_ok()) && take.frames() == frames);
    }
}
