//! Programs that die while they record: killed at any moment, and writers that meet.

mod take_scene;

use lovelock_record::{TakeCondition, TakeError, TakeReader, TakeWriter};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{env, fs};
use take_scene::{Random, Size, frame, header, play_all, project, record};

const SIZE: Size = Size(30, 10);

/// Where the program that is to be killed records to, and how many frames.
const CHILD: &str = "LOVELOCK_TEST_TAKE_CHILD";

/// Frames of a recording that is killed before its end, and of one that may come to it.
const LONG: u64 = 100_000;
const SHORT: u64 = 150;

/// Not a test of its own: the program that the test below starts and kills. It says how many frames are kept.
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
            // A recording gives the disk a second; this one waits until it is done.
            while writer.kept_frames() <= n {
                std::thread::yield_now();
            }
            writeln!(out, "kept {}", n + 1).unwrap();
            out.flush().unwrap();
        }
    }
    writer.finish().unwrap();
}

/// Starts the program, kills it some time after it has begun; says how many frames it knew to be kept.
fn killed(path: &Path, frames: u64, after: Duration) -> u64 {
    let mut child = Command::new(env::current_exe().unwrap())
        .args(["a_program_that_records", "--exact", "--nocapture", "--test-threads", "1"])
        .env(CHILD, format!("{frames} {}", path.display()))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    let kept = |line: &String| line.strip_prefix("kept ").and_then(|n| n.parse::<u64>().ok());
    let first = lines.by_ref().find_map(|line| kept(&line)).unwrap();
    std::thread::sleep(after);
    child.kill().unwrap();
    child.wait().unwrap();
    // What it had said until then is still in the pipe; a line that was not said whole does not count.
    lines.filter_map(|line| kept(&line)).last().unwrap_or(first)
}

#[test]
fn a_recording_that_is_killed_plays_up_to_its_last_second() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(11);
    let (mut finished, mut longest) = (0, 0);
    for run in 0..100 {
        let path = folder.path().join(format!("{run}.take"));
        let part = folder.path().join(format!("{run}.take.part"));
        let frames = if run % 4 == 0 { SHORT } else { LONG };
        let kept = killed(&path, frames, Duration::from_micros(random.below(30_000) as u64));
        if path.exists() {
            // It had come to its end.
            assert!(frames == SHORT && !part.exists());
            let mut take = TakeReader::open(&path).unwrap();
            assert!(take.condition().is_whole());
            assert_eq!(play_all(&mut take, SIZE), SHORT);
            finished += 1;
            continue;
        }
        let mut take = TakeReader::open(&part).unwrap();
        let condition = take.condition();
        // Between its last byte and its name it is whole already.
        let all_but_named = condition.is_whole() && frames == SHORT && take.frames() == SHORT;
        assert!(all_but_named || matches!(condition, TakeCondition::Cut { .. }), "{run}: {condition}");
        // Nothing that was known to be kept is lost, and no more than the next chunk can have followed, said or not.
        let played = play_all(&mut take, SIZE);
        assert!(played >= kept && played <= kept + 60, "{run}: {kept} were kept, {played} play");
        longest = longest.max(played);
        fs::remove_file(&part).unwrap();
    }
    // The control: they were killed in their middle.
    println!("{finished} of 25 came to their end; the longest was killed after frame {longest}");
    assert!(longest > 120 && finished < 100);
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
    // The take that was there stays until the new one is whole.
    assert_eq!(TakeReader::open(&path).unwrap().frames(), 70);
    assert_eq!(first.finish().unwrap().frames, 100);
    assert_eq!(TakeReader::open(&path).unwrap().frames(), 100);
    // The control: a writer that is done does not stand in the way.
    TakeWriter::create(&path, header(SIZE)).unwrap().discard().unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn what_a_writer_left_unfinished_is_kept() {
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
