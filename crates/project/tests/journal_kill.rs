//! Programs that are killed while a project is edited and saved.

use std::env;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use lovelock_base::random::SplitMix64;
use lovelock_groom::{GroomSettings, PlainHead, grow};
use lovelock_project::Project;
use lovelock_project::date::{now, unix_ms};
use lovelock_project::document::Document;
use lovelock_project::journal::{Journal, Journals};
use lovelock_project::project::{Marker, load_project, save_project};
use lovelock_style::hand::{HandEdit, HandRoots};
use lovelock_style::operations::Hand;
use lovelock_style::{Layer, Operation};
use lovelock_testkit::suite;

/// Environment variable with the folder and the seed of the program that is killed.
const CHILD: &str = "LOVELOCK_TEST_JOURNAL_CHILD";

/// The oldest edit that may be lost, milliseconds. The rest of a second, over 200 ms between two writes, is for a busy machine.
const MOST_LOST_MS: u64 = 1000;

fn project_in(folder: &Path) -> PathBuf {
    folder.join("dance ü.lovelock")
}

fn journals_in(folder: &Path) -> Journals {
    Journals::new(folder.join("state"))
}

/// The number of the edit that a project is in: each writes its own.
fn edit_of(project: &Project) -> u64 {
    project.timeline.markers.first().map_or(0, |marker| marker.name.parse().expect("a number"))
}

/// A number from 0 to below `end`.
fn below(random: &mut SplitMix64, end: u64) -> u64 {
    random.bits() % end
}

/// The newest edit of a document: it may have been undone.
fn newest_of(document: &Document) -> u64 {
    let mut redone = document.clone();
    let mut newest = edit_of(redone.project());
    while redone.redo() {
        newest = newest.max(edit_of(redone.project()));
    }
    newest
}

/// What a start does: recovers what was not saved, or opens what was.
fn start(folder: &Path, journal: &mut Journal) -> Document {
    let path = project_in(folder);
    let mut unsaved = journals_in(folder).unsaved(Some(&path)).into_iter();
    let document = match unsaved.next() {
        Some(newest) => {
            let document = Document::recovered(newest.history().expect("a history"), newest.project.clone());
            journal.replaces(newest);
            document
        }
        None => Document::new(load_project(&path).expect("a project").0, Some(path)),
    };
    unsaved.for_each(lovelock_project::journal::Unsaved::discard);
    document
}

/// Not a test of its own: the program that the tests below start and kill. It prints each edit with its time.
#[test]
fn a_program_that_edits() {
    let Ok(told) = env::var(CHILD) else { return };
    let (seed, folder) = told.split_once(' ').expect("two values");
    let (mut random, folder) = (SplitMix64::new(seed.parse().expect("a number")), PathBuf::from(folder));
    let mut journal = Journal::new(journals_in(&folder)).expect("a thread");
    let mut document = start(&folder, &mut journal);
    let mut edit = newest_of(&document);
    let mut out = std::io::stdout();
    let mut say = |what: &str, edit: u64| {
        writeln!(out, "{what} {edit} {}", unix_ms(now())).expect("a reader");
        out.flush().expect("a reader");
    };
    say("began", edit);
    let settings =
        GroomSettings { wisps: 60, strands_per_wisp: 2, segments_per_strand: 8, ..GroomSettings::default() };
    let hair = grow(&settings, &PlainHead.scalp(16), &PlainHead).expect("hair");
    let roots = HandRoots::of(&hair);
    loop {
        match below(&mut random, 40) {
            0 => {
                // An edit may have been undone.
                let kept = edit_of(document.project());
                say("saving", kept);
                save_project(&project_in(&folder), document.project()).expect("saved");
                document.mark_saved(&project_in(&folder));
                say("saved", kept);
            }
            1 | 2 => {
                document.undo();
            }
            3 => {
                document.redo();
            }
            // A stroke of a brush.
            4 => {
                edit += 1;
                let change = HandEdit { length: 0.5 + 0.001 * (edit % 400) as f32, ..HandEdit::default() };
                let guides = (0..9).map(|k| ((edit as usize * 7 + k) % hair.guides.count(), change.clone()));
                document.change("comb", |project| {
                    project.timeline.markers = vec![Marker { secs: 1.0, name: edit.to_string() }];
                    let stack = &mut project.hair.stack;
                    if stack.layers.is_empty() {
                        stack.push(Layer::of(Hand::default()));
                    }
                    if let Operation::Hand(hand) = &mut stack.layers[0].operation {
                        hand.edits.change(&roots, guides);
                    }
                });
                say("edit", edit);
            }
            // A drag: many changes that are one step.
            5..=20 => {
                let mut project = Project::clone(document.project());
                edit += 1;
                project.timeline.markers = vec![Marker { secs: 1.0, name: edit.to_string() }];
                project.look.grey = below(&mut random, 1000) as f32 * 1e-3;
                document.edit("marker", project);
                say("edit", edit);
            }
            _ => {
                edit += 1;
                document.change("marker", |project| {
                    project.timeline.markers = vec![Marker { secs: 1.0, name: edit.to_string() }];
                });
                say("edit", edit);
            }
        }
        journal.follow(&document);
        std::thread::sleep(Duration::from_millis(below(&mut random, 12)));
    }
}

/// What a program said until it was killed.
struct Killed {
    /// The edits with their times, milliseconds since 1970.
    edits: Vec<(u64, u64)>,
    /// The last edit that was saved, also before this program, and those whose saving may have ended since.
    saved: Vec<u64>,
    at_ms: u64,
}

fn killed(folder: &Path, seed: u64, after: Duration) -> Killed {
    let saved_before = edit_of(&load_project(&project_in(folder)).expect("a project").0);
    let mut child = Command::new(env::current_exe().expect("this program"))
        .args(["a_program_that_edits", "--exact", "--nocapture", "--test-threads", "1"])
        .env(CHILD, format!("{seed} {}", folder.display()))
        .stdout(Stdio::piped())
        .stderr(Stdio::inherit())
        .spawn()
        .expect("started");
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines().map_while(Result::ok);
    // The test harness prints before it, on the same line.
    let began = lines.by_ref().find(|line| line.contains("began ")).expect("a start that does not fail");
    let mut killed = Killed { edits: Vec::new(), saved: vec![saved_before], at_ms: 0 };
    let mut take = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [.., what, edit, ms] = words[..] else { return };
        let (Ok(edit), Ok(ms)) = (edit.parse(), ms.parse()) else { return };
        match what {
            "saving" => killed.saved.push(edit),
            "saved" => killed.saved = vec![edit],
            _ => killed.edits.push((edit, ms)),
        }
    };
    take(&began);
    let read = std::thread::scope(|scope| {
        let reader = scope.spawn(move || lines.collect::<Vec<_>>());
        std::thread::sleep(after);
        child.kill().expect("killed");
        child.wait().expect("ended");
        reader.join().expect("read")
    });
    for line in &read {
        take(line);
    }
    // The last sign of life: the machine may have been slow to kill it.
    killed.at_ms = killed.edits.last().map_or(0, |edit| edit.1);
    killed
}

/// Kills programs one after another in one folder. Returns the largest time of lost edits in milliseconds, and the number of edits.
fn kill_many(kills: u64, seed: u64, most_ms: u64) -> (u64, u64) {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    save_project(&project_in(folder), &Project::default()).expect("saved");
    let mut random = SplitMix64::new(seed);
    let (mut worst, mut edits) = (0, 0);
    for run in 0..kills {
        let after = Duration::from_millis(below(&mut random, most_ms));
        let told = killed(folder, seed * 1000 + run, after);
        // The file of the project is whole, whatever happened while it was saved.
        let (saved, problems) = load_project(&project_in(folder)).expect("a whole file");
        assert!(problems.is_empty(), "{problems:?}");
        let mut journal = Journal::new(journals_in(folder)).expect("a thread");
        let mut document = start(folder, &mut journal);
        let newest = newest_of(&document).max(edit_of(&saved));
        let lost = told.edits.iter().find(|(edit, _)| *edit > newest);
        let lost_ms = lost.map_or(0, |(_, ms)| told.at_ms - ms);
        assert!(lost_ms <= MOST_LOST_MS, "run {run}: edits of {lost_ms} ms are lost");
        let of_file = edit_of(&saved);
        assert!(told.saved.contains(&of_file), "run {run}: {of_file} in place of one of {:?}", told.saved);
        // Every step back is a project that was there before.
        let mut before = edit_of(document.project());
        while document.undo() {
            let edit = edit_of(document.project());
            assert!(edit < before, "run {run}: {edit} before {before}");
            before = edit;
        }
        // The next program finds what this one found.
        drop(document);
        let document = start(folder, &mut journal);
        if document.is_modified() {
            assert!(journal.flush(&document, Duration::from_secs(20)));
        }
        drop(journal);
        (worst, edits) = (worst.max(lost_ms), edits + told.edits.len() as u64);
    }
    (worst, edits)
}

#[test]
fn programs_that_are_killed_lose_at_most_the_last_second() {
    let (worst, edits) = kill_many(5, 1, 900);
    println!("at most {worst} ms of {edits} edits were lost");
    assert!(edits > 50, "the programs were killed before they did much");
}

#[test]
fn long_suite_three_hundred_kills_lose_at_most_the_last_second_each() {
    if !suite::is_long() {
        return;
    }
    // In several folders: each program reads all that was undone before it.
    let rounds = (2..8).map(|seed| kill_many(50, seed, 2500));
    let (worst, edits) = rounds.fold((0, 0), |(worst, edits), (ms, more)| (ms.max(worst), edits + more));
    println!("at most {worst} ms of {edits} edits were lost in 300 kills");
    assert!(edits > 3000);
}
