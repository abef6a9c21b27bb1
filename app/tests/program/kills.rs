//! The whole program, killed at random instants while it records. What has its final name is whole; the next start offers what is left, and
//! that can be kept or discarded without a trace.

use std::fs;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_base::random::SplitMix64;
use lovelock_project::unfinished::Recordings;
use lovelock_record::{
    FilmReader, MANIFEST_NAME, RecordError, TakeCondition, TakeError, TakeReader, UnfinishedKind,
    discard_unfinished, is_unfinished, keep_unfinished, read_manifest,
};
use lovelock_testkit::wait::wait_until;
use tempfile::TempDir;

use crate::tool::{lovelock, names, run_command, saved, small_project};

/// The time that a recording shall take without loading, milliseconds, and the frames from which its length is found.
const RUN_MS: f64 = 3000.0;
const PROBED: u64 = 60;

/// Tables of a film are written when they are a second old and a chunk of images is complete; the rest of the time is for a busy machine.
const TABLES_SECS: f64 = 1.25;
const CHUNK: u64 = 16;
/// Images that were handed over and are in a queue or being encoded: of a film, and of a sequence with four threads.
const IN_FLIGHT: [u64; 2] = [4, 10];
/// Steps of a take that are in memory: six chunks, of which four wait for the disk.
const STEPS_IN_FLIGHT: u64 = 6 * 30;

/// From when on the time to the kill is counted.
#[derive(Clone, Copy, Debug)]
enum Moment {
    Start,
    /// When the output has been begun.
    Output,
    /// When few frames are left.
    End,
}

/// A recording of one kind, and what it is when nobody kills it.
struct Recording {
    kind: UnfinishedKind,
    /// The project, and the recording that nobody killed.
    dir: TempDir,
    frames: u64,
    /// How long it takes, with loading.
    secs: f64,
    /// Images, or steps of a take.
    whole: u64,
    /// Hashes of the images of a film.
    images: Vec<u64>,
}

/// What a program had done when it was killed.
struct Killed {
    /// Frames that it reported, with the seconds since its start.
    reported: Vec<(f64, u64)>,
    at_secs: f64,
    /// Whether it had ended by itself.
    ended: bool,
}

/// What many kills left.
#[derive(Debug, Default)]
struct Totals {
    unfinished: u64,
    longest_kept: u64,
    was_damaged: bool,
}

impl Recording {
    /// One of so many frames, or of as many as take [`RUN_MS`].
    fn new(kind: UnfinishedKind, frames: Option<u64>) -> Self {
        let dir = tempfile::tempdir().expect("a folder");
        saved(dir.path(), "p.lovelock", &small_project());
        let frames_now = frames.unwrap_or(PROBED);
        let mut recording = Self { kind, dir, frames: frames_now, secs: 0.0, whole: 0, images: Vec::new() };
        if frames.is_none() {
            let json = run_command(&mut recording.command(&recording.dir.path().join("probe"))).done().json();
            let ms = match kind {
                UnfinishedKind::Take => json["ms"].as_f64().expect("a time") / PROBED as f64,
                UnfinishedKind::Film | UnfinishedKind::Sequence => json["frame_ms"].as_f64().expect("a time"),
            };
            recording.frames = ((RUN_MS / ms.max(1e-3)) as u64).clamp(150, 4000);
        }
        let since = Stopwatch::start();
        run_command(&mut recording.command(&recording.reference())).done();
        recording.secs = since.secs();
        let out = recording.out(&recording.reference());
        match kind {
            UnfinishedKind::Film => {
                recording.images = images_of(&out).expect("a film");
                recording.whole = recording.images.len() as u64;
            }
            UnfinishedKind::Sequence => recording.whole = recording.frames,
            UnfinishedKind::Take => recording.whole = TakeReader::open(&out).expect("a take").frames(),
        }
        assert_eq!(recording.held(&out), Ok(recording.whole), "control");
        recording
    }

    fn reference(&self) -> PathBuf {
        self.dir.path().join("whole")
    }

    /// Names in other scripts, with a space.
    fn name(&self) -> &'static str {
        match self.kind {
            UnfinishedKind::Film => "踊り ü.mp4",
            UnfinishedKind::Sequence => "踊り ü",
            UnfinishedKind::Take => "踊り ü.take",
        }
    }

    fn out(&self, place: &Path) -> PathBuf {
        place.join("out").join(self.name())
    }

    /// The command that records into the folder `out` of a place, with `state` for what the program remembers.
    fn command(&self, place: &Path) -> Command {
        fs::create_dir_all(place.join("out")).expect("a folder");
        let mut command = lovelock();
        command.arg("record").arg(self.dir.path().join("p.lovelock")).arg("-o").arg(self.out(place));
        command.args(["--frames", &format!("0..{}", self.frames), "--json"]);
        command.env("LOVELOCK_STATE", place.join("state"));
        command
    }

    /// Starts the program and kills it.
    fn killed(&self, place: &Path, from: Moment, after: Duration) -> Killed {
        let mut command = self.command(place);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        let since = Stopwatch::start();
        let lines = BufReader::new(child.stderr.take().expect("a pipe")).lines().map_while(Result::ok);
        let begun = match self.kind {
            UnfinishedKind::Film => self.out(place).with_file_name(format!("{}.partial", self.name())),
            UnfinishedKind::Sequence => self.out(place).join("manifest.partial"),
            UnfinishedKind::Take => self.out(place).with_file_name(format!("{}.part", self.name())),
        };
        let (reported, said) = (Mutex::new(Vec::<(f64, u64)>::new()), Mutex::new(Vec::<String>::new()));
        let (at_secs, ended) = std::thread::scope(|scope| {
            scope.spawn(|| {
                for line in lines {
                    let number = line.strip_prefix("frame ").and_then(|rest| rest.split(' ').next());
                    match number.and_then(|number| number.parse::<u64>().ok()) {
                        Some(frame) => locked(&reported).push((since.secs(), frame)),
                        None => locked(&said).push(line),
                    }
                }
            });
            let is_near_end = || locked(&reported).last().is_some_and(|last| 20 * last.1 >= 19 * self.frames);
            wait_until("the moment from which the time is counted", || {
                let is_time = match from {
                    Moment::Start => true,
                    Moment::Output => begun.exists(),
                    Moment::End => is_near_end(),
                };
                is_time || child.try_wait().expect("its state").is_some()
            });
            std::thread::sleep(after);
            let ended = child.try_wait().expect("its state").is_some();
            let at_secs = since.secs();
            // It may end at this very moment.
            let _ = child.kill();
            let status = child.wait().expect("its end");
            assert!(!ended || status.success(), "it failed by itself: {:?}", locked(&said));
            (at_secs, ended)
        });
        Killed { reported: reported.into_inner().unwrap_or_else(PoisonError::into_inner), at_secs, ended }
    }

    /// The frames of an output, each of which must be as in the recording that nobody killed.
    fn held(&self, out: &Path) -> Result<u64, String> {
        match self.kind {
            UnfinishedKind::Film => {
                let images = images_of(out)?;
                let is_same = self.images.starts_with(&images);
                is_same.then_some(images.len() as u64).ok_or_else(|| "other images".to_owned())
            }
            UnfinishedKind::Sequence => {
                let manifest = read_manifest(out).map_err(|error| error.to_string())?;
                let listed = manifest.frames.iter().map(|frame| frame.file.as_str());
                let listed: Vec<&str> = listed.chain([MANIFEST_NAME]).collect();
                if names(out) != listed {
                    return Err(format!("found {:?}; the manifest lists {listed:?}", names(out)));
                }
                self.images_in(out)
            }
            UnfinishedKind::Take => self.steps_of(out),
        }
    }

    /// The images of a folder, finished or not, which must be whole.
    fn images_in(&self, folder: &Path) -> Result<u64, String> {
        let reference = self.out(&self.reference());
        let is_image = |name: &String| Path::new(name).extension().is_some_and(|ending| ending == "png");
        let images: Vec<String> = names(folder).into_iter().filter(is_image).collect();
        let differs =
            |name: &&String| fs::read(folder.join(name)).ok() != fs::read(reference.join(name)).ok();
        match images.iter().find(differs) {
            Some(name) => Err(format!("{name} is damaged")),
            None => Ok(images.len() as u64),
        }
    }

    fn steps_of(&self, take: &Path) -> Result<u64, String> {
        let told = |error: TakeError| error.to_string();
        let mut reader = TakeReader::open(take).map_err(told)?;
        let mut whole = TakeReader::open(&self.out(&self.reference())).map_err(told)?;
        if let condition @ TakeCondition::Damaged { .. } = reader.verify().map_err(told)? {
            return Err(condition.to_string());
        }
        for step in 0..reader.frames() {
            if reader.frame(step).map_err(told)? != whole.frame(step).map_err(told)? {
                return Err(format!("step {step} is another"));
            }
        }
        Ok(reader.frames())
    }

    /// Checks what is left, as the next start finds it, and keeps or discards it.
    fn check(&self, place: &Path, killed: &Killed, keeps: bool, totals: &mut Totals) {
        let (folder, out) = (place.join("out"), self.out(place));
        let is_sequence = self.kind == UnfinishedKind::Sequence;
        let named = if is_sequence { out.join(MANIFEST_NAME) } else { out.clone() };
        if named.exists() {
            assert_eq!(self.held_beside_rest(&out), Ok(self.whole), "what has its name is whole");
        }
        if is_sequence && out.exists() {
            self.images_in(&out).expect("an image with its name is whole");
        }
        let notes = place.join("state").join("recordings");
        let recordings = Recordings::new(&notes);
        let offered = recordings.interrupted();
        assert_eq!(offered.len(), usize::from(is_unfinished(&out)), "{offered:?}");
        let mut kept_name = named.exists().then(|| self.name());
        if let [work] = &offered[..] {
            totals.unfinished += 1;
            assert_eq!((work.job.out.as_path(), work.kind), (out.as_path(), self.kind));
            let project = work.job.project().expect("the project to record again");
            assert_eq!((project.recording.width, project.recording.height), (96, 64));
            assert!(work.job.command.as_ref().is_some_and(|words| words.iter().any(|word| word == "record")));
            let kept = if keeps { keep_unfinished(&out).expect("nothing stands against it") } else { None };
            if let Some(kept) = &kept {
                assert_eq!((kept.path.as_path(), self.held(&out)), (out.as_path(), Ok(kept.frames)));
                totals.longest_kept = totals.longest_kept.max(kept.frames);
                if !totals.was_damaged && kept.frames >= CHUNK {
                    self.assert_damage_is_noticed(&folder, kept.frames);
                    totals.was_damaged = true;
                }
            }
            if keeps {
                let (kept, least) = (kept.as_ref().map_or(0, |kept| kept.frames), self.least_kept(killed));
                println!("of {} {} are kept; at least {least} must be", self.whole, self.kind.label());
                assert!(kept >= least, "{kept} of at least {least} are kept: {:?}", killed.reported);
            }
            if kept.is_none() {
                discard_unfinished(&out).expect("nothing stands against it");
            }
            kept_name = kept.map(|_| self.name()).or(kept_name);
            work.forget();
        } else {
            assert!(named.exists() || !killed.ended, "it ended and left nothing");
            if kept_name.is_none() {
                // Killed when it had made the folder, which is empty.
                let _ = fs::remove_dir(&out);
            }
        }
        assert_eq!(only(&folder, kept_name), Ok(()));
        assert!(recordings.interrupted().is_empty() && !is_unfinished(&out));
        assert_eq!(fs::read_dir(&notes).into_iter().flatten().count(), 0, "notes are left");
    }

    /// [`Recording::held`] of an output that has its name, while a sequence may still have the journal.
    fn held_beside_rest(&self, out: &Path) -> Result<u64, String> {
        if self.kind != UnfinishedKind::Sequence {
            return self.held(out);
        }
        let manifest = read_manifest(out).map_err(|error| error.to_string())?;
        let images = self.images_in(out)?;
        let is_whole = manifest.complete && manifest.frames.len() as u64 == images;
        is_whole.then_some(images).ok_or_else(|| format!("{} of {images} are listed", manifest.frames.len()))
    }

    /// The frames or steps that must be kept of a recording that was killed.
    fn least_kept(&self, killed: &Killed) -> u64 {
        let last = killed.reported.last().map_or(0, |&(_, frame)| frame);
        match self.kind {
            UnfinishedKind::Film => {
                // Those that were handed over a second before the kill, and the time of a chunk of images, at the slowest pace.
                let times = killed.reported.iter().map(|&(at, _)| at);
                let ends = times.clone().skip(1).chain([killed.at_secs]);
                let slowest = times.zip(ends).map(|(at, end)| end - at).fold(0.0, f64::max);
                let between = (self.frames / 20).max(1);
                let secs = TABLES_SECS + slowest * (CHUNK.div_ceil(between) + 1) as f64;
                let is_before = |&&(at, _): &&(f64, u64)| at <= killed.at_secs - secs;
                let before = killed.reported.iter().rev().find(is_before).map_or(0, |&(_, frame)| frame);
                before.saturating_sub(IN_FLIGHT[0])
            }
            UnfinishedKind::Sequence => last.saturating_sub(IN_FLIGHT[1]),
            UnfinishedKind::Take => (last * (self.whole / self.frames)).saturating_sub(STEPS_IN_FLIGHT),
        }
    }

    /// The control: a file that is cut or changed is not taken for what was kept, and neither is one too many.
    fn assert_damage_is_noticed(&self, folder: &Path, frames: u64) {
        let out = folder.join(self.name());
        let file =
            if self.kind == UnfinishedKind::Sequence { out.join("frame_000000.png") } else { out.clone() };
        let bytes = fs::read(&file).expect("the file");
        let middle = bytes.len() / 2;
        let mut changed = bytes.clone();
        changed[middle..middle + 16].iter_mut().for_each(|byte| *byte ^= 0x55);
        for damaged in [&bytes[..bytes.len() - 9], &changed[..]] {
            fs::write(&file, damaged).expect("written");
            assert_ne!(self.held(&out), Ok(frames), "damage goes unnoticed");
        }
        fs::write(&file, &bytes).expect("written");
        assert_eq!(self.held(&out), Ok(frames));
        let more = folder.join("踊り ü.mp4.partial.tables");
        fs::write(&more, b"x").expect("written");
        assert!(only(folder, Some(self.name())).is_err(), "a file too many goes unnoticed");
        fs::remove_file(more).expect("removed");
    }
}

/// Whether a folder holds only what was kept.
fn only(folder: &Path, kept: Option<&str>) -> Result<(), String> {
    let found = names(folder);
    if found.iter().map(String::as_str).eq(kept) { Ok(()) } else { Err(format!("{found:?} are left")) }
}

/// The hashes of the images of a film.
fn images_of(film: &Path) -> Result<Vec<u64>, String> {
    let read = || -> Result<Vec<u64>, RecordError> {
        let mut reader = FilmReader::open(film)?;
        let (mut images, mut image) = (Vec::new(), Vec::new());
        while reader.next_frame(&mut image)? {
            let mut hasher = DefaultHasher::new();
            image.hash(&mut hasher);
            images.push(hasher.finish());
        }
        Ok(images)
    };
    read().map_err(|error| error.to_string())
}

fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Kills a recording many times, and keeps or discards what is left.
fn kill_many(recording: &Recording, kills: u64, seed: u64) -> Totals {
    let mut random = SplitMix64::new(seed);
    let mut totals = Totals::default();
    for kill in 0..kills {
        let place = tempfile::tempdir().expect("a folder");
        let (from, most) = match kill % 4 {
            0 | 1 => (Moment::Output, 0.9 * recording.secs),
            2 => (Moment::End, 0.1 * recording.secs),
            _ => (Moment::Start, recording.secs),
        };
        let after = random.unit_f64() * most;
        println!("kill {kill}, {after:.3} s from {from:?}");
        let killed = recording.killed(place.path(), from, Duration::from_secs_f64(after));
        // Two of three are kept; each moment has both.
        recording.check(place.path(), &killed, kill % 3 != 2, &mut totals);
    }
    totals
}

#[test]
fn a_program_that_is_killed_while_it_records_leaves_whole_images() {
    let recording = Recording::new(UnfinishedKind::Sequence, Some(96));
    let mut totals = Totals::default();
    // On a fast machine it may have ended before it is killed.
    for after_ms in [60, 20, 10, 5, 0] {
        let place = tempfile::tempdir().expect("a folder");
        let killed = recording.killed(place.path(), Moment::Output, Duration::from_millis(after_ms));
        recording.check(place.path(), &killed, true, &mut totals);
        if totals.unfinished > 0 {
            break;
        }
    }
    assert!(totals.unfinished > 0, "nothing was killed");
}

#[test]
fn sixty_kills_damage_nothing_and_lose_at_most_the_last_second_long_suite() {
    for (kind, seed) in [(UnfinishedKind::Film, 1), (UnfinishedKind::Sequence, 2), (UnfinishedKind::Take, 3)]
    {
        let recording = Recording::new(kind, None);
        println!("{kind:?}: {} frames in {:.1} s", recording.frames, recording.secs);
        let totals = kill_many(&recording, 20, seed);
        println!("{totals:?} of {}", recording.whole);
        // Negative controls: most were killed before their end, some of them late, and damage was noticed.
        assert!(totals.unfinished >= 8, "{totals:?}");
        assert!(totals.longest_kept > recording.whole / 10 && totals.was_damaged, "{totals:?}");
    }
}
