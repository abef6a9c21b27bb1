//! Recordings that are being made, so that one that a crash interrupts is offered again.
//!
//! Each has a file in a folder of the user, which is locked while the recording runs and removed at its end.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::date;
use lovelock_record::{UnfinishedKind, claim, has_left, has_older, tidy_finished, unfinished_outs};
use serde::{Deserialize, Serialize};

use crate::Project;
use crate::error::ProjectError;
use crate::project::{project_in_memory, text_in_memory};
use crate::state_folder::state_folder;

/// The extension of the files.
const EXTENSION: &str = "json";
/// The longest file that is read, bytes.
const LONGEST: u64 = 80 << 20;
/// The most recordings that are listed.
const MOST: usize = 200;

/// What a recording needs to be made again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Job {
    /// The film, folder or take.
    pub out: PathBuf,
    /// When it began, milliseconds since 1970.
    pub since_ms: u64,
    /// The project, as text with absolute paths.
    project: String,
    /// Whether the panes of the project are recorded beside each other.
    pub panes: bool,
    /// The command line, if it was recorded from there.
    pub command: Option<Vec<String>>,
}

impl Job {
    /// The recording of a project to `out`, from now on.
    pub fn new(out: &Path, project: &Project, panes: bool) -> Self {
        Self {
            out: std::path::absolute(out).unwrap_or_else(|_| out.to_owned()),
            since_ms: date::unix_ms(date::now()),
            project: text_in_memory(project).unwrap_or_default(),
            panes,
            command: None,
        }
    }

    /// The project.
    ///
    /// # Errors
    /// If its text cannot be read.
    pub fn project(&self) -> Result<Project, ProjectError> {
        project_in_memory(&self.out, &self.project)
    }

    /// When it began.
    pub fn since(&self) -> SystemTime {
        date::of_unix_ms(self.since_ms)
    }
}

/// The recordings of the user.
#[derive(Clone, Debug, Default)]
pub struct Recordings {
    folder: Option<PathBuf>,
}

/// A recording that runs. Dropping it says that it has ended.
#[derive(Debug)]
pub struct Running {
    path: PathBuf,
    out: PathBuf,
    since: SystemTime,
    /// Locked as long as it is open.
    _file: File,
}

impl Drop for Running {
    fn drop(&mut self) {
        // One that could not be written to its end, as on a full disk, is offered like one that a crash left.
        if !has_left(&self.out, self.since) {
            // A note that stays is not listed unless the recording has left something.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// A recording that was interrupted.
#[derive(Clone, Debug, PartialEq)]
pub struct Interrupted {
    /// Its file.
    path: PathBuf,
    /// The name that was recorded. A take has another one by now if that name was recorded again.
    noted: PathBuf,
    /// Whether an older recording of that name has a note, too.
    is_noted_twice: bool,
    /// What it needs.
    pub job: Job,
    /// Its kind.
    pub kind: UnfinishedKind,
}

impl Interrupted {
    /// Forgets it: it was kept, discarded or is recorded again.
    pub fn forget(&self) {
        // Another part of a take, or an older film, may have no note but this one.
        let is_needed = match self.kind {
            UnfinishedKind::Film => has_older(&self.job.out) && !self.is_noted_twice,
            UnfinishedKind::Sequence => false,
            UnfinishedKind::Take => unfinished_outs(&self.noted).iter().any(|out| *out != self.job.out),
        };
        if !is_needed {
            let _ = fs::remove_file(&self.path);
        }
    }
}

impl Recordings {
    /// Those of the user: [`state_folder`]`/recordings`.
    pub fn of_user() -> Self {
        Self { folder: state_folder().map(|folder| folder.join("recordings")) }
    }

    /// Those in `folder`, which need not be there yet.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: Some(folder.into()) }
    }

    /// Notes a recording that begins. `None` if it would leave nothing, or if it cannot be noted: then it is not offered again.
    pub fn begin(&self, job: &Job) -> Option<Running> {
        UnfinishedKind::of(&job.out)?;
        let folder = self.folder.as_ref()?;
        fs::create_dir_all(folder).ok()?;
        let name = crc32fast::hash(job.out.as_os_str().as_encoded_bytes());
        let path = folder.join(format!("{}-{name:08x}-{}.{EXTENSION}", job.since_ms, std::process::id()));
        let mut file = claim(&path).ok()?;
        let running =
            Running { path, out: job.out.clone(), since: job.since(), _file: file.try_clone().ok()? };
        file.write_all(&serde_json::to_vec(job).ok()?).ok()?;
        Some(running)
    }

    /// The recordings that were interrupted and have left something, the newest first. Files of the others are removed.
    pub fn interrupted(&self) -> Vec<Interrupted> {
        let entries = self.folder.as_ref().and_then(|folder| fs::read_dir(folder).ok());
        let paths = entries.into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
        let mut paths: Vec<PathBuf> =
            paths.filter(|path| path.extension().is_some_and(|found| found == EXTENSION)).collect();
        paths.sort();
        paths.reverse();
        // Locked until all are known.
        let mut notes: Vec<(PathBuf, Job, File)> = Vec::new();
        for path in paths.into_iter().take(MOST) {
            // One that runs is locked.
            let Ok(lock) = claim(&path) else { continue };
            // Through the lock, because some systems let no other handle read a locked file.
            let mut text = Vec::new();
            if (&lock).take(LONGEST).read_to_end(&mut text).is_err() {
                continue;
            }
            match serde_json::from_slice(&text) {
                Ok(job) => notes.push((path, job, lock)),
                Err(_) => drop(fs::remove_file(&path)),
            }
        }
        let mut found: Vec<Interrupted> = Vec::new();
        for (k, (path, job, _)) in notes.iter().enumerate() {
            let mut outs = unfinished_outs(&job.out);
            if outs.is_empty() {
                tidy_finished(&job.out);
            }
            outs.retain(|out| found.iter().all(|other| other.job.out != *out));
            let Some(kind) = UnfinishedKind::of(&job.out).filter(|_| !outs.is_empty()) else {
                // An older film is offered when the newer one of its name is kept or discarded.
                if !has_older(&job.out) {
                    let _ = fs::remove_file(path);
                }
                continue;
            };
            // An older note of the same name is that of an older part; the oldest has all that are left.
            let is_noted_twice = notes[k + 1..].iter().any(|(_, older, _)| older.out == job.out);
            if is_noted_twice {
                outs.truncate(1);
            }
            let of = |out| Interrupted {
                path: path.clone(),
                noted: job.out.clone(),
                is_noted_twice,
                job: Job { out, ..job.clone() },
                kind,
            };
            found.extend(outs.into_iter().map(of));
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn a_recording_is_offered_if_it_was_interrupted_and_left_something() {
        let folder = tempfile::tempdir().expect("a folder");
        let recordings = Recordings::new(folder.path().join("state"));
        let film = folder.path().join("dance ü.mp4");
        let mut project = Project::default();
        project.camera.distance = 3.0;
        let job = Job::new(&film, &project, true);
        let running = recordings.begin(&job).expect("noted");
        fs::write(folder.path().join("dance ü.mp4.partial"), b"x").expect("a file");
        assert!(recordings.interrupted().is_empty(), "it runs");
        // As a crash does: the lock goes, the file stays.
        let copy = fs::read(&running.path).expect("a file");
        let path = running.path.clone();
        drop(running);
        fs::write(&path, &copy).expect("a file");
        let found = recordings.interrupted();
        assert_eq!((found.len(), found[0].kind, &found[0].job), (1, UnfinishedKind::Film, &job));
        assert_eq!(found[0].job.project().expect("a project"), project);
        found[0].forget();
        assert!(recordings.interrupted().is_empty());
        // One that left nothing is not offered, nor is a damaged file. A film that got its name may have left its tables.
        fs::write(&path, &copy).expect("a file");
        fs::write(path.with_file_name("x.json"), b"{").expect("a file");
        let tables = folder.path().join("dance ü.mp4.partial.tables");
        fs::rename(folder.path().join("dance ü.mp4.partial"), &tables).expect("renamed");
        assert!(recordings.interrupted().is_empty() && !tables.exists());
        assert_eq!(fs::read_dir(folder.path().join("state")).expect("a folder").count(), 0);
        assert!(recordings.begin(&Job::new(Path::new("a.apng"), &project, false)).is_none());
    }

    /// The memory of this process stands for a note that cannot be read: it can be opened and locked, and nothing is at its start.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_note_that_cannot_be_read_stays_and_one_that_is_no_note_goes() {
        let folder = tempfile::tempdir().expect("a folder");
        let recordings = Recordings::new(folder.path());
        let [unread, damaged] = ["2.json", "1.json"].map(|name| folder.path().join(name));
        std::os::unix::fs::symlink("/proc/self/mem", &unread).expect("a link");
        fs::write(&damaged, b"{").expect("a file");
        assert!(recordings.interrupted().is_empty());
        assert!(unread.is_symlink() && !damaged.exists());
        // Control: a link is read as any other note.
        let job = Job::new(&folder.path().join("dance.mp4"), &Project::default(), false);
        fs::write(folder.path().join("dance.mp4.partial"), b"x").expect("a file");
        fs::write(folder.path().join("note"), serde_json::to_vec(&job).expect("text")).expect("a file");
        std::os::unix::fs::symlink(folder.path().join("note"), &damaged).expect("a link");
        assert_eq!(recordings.interrupted().len(), 1);
    }

    #[test]
    fn an_older_film_is_offered_after_the_newer_one_of_its_name() {
        for has_own_note in [true, false] {
            let folder = tempfile::tempdir().expect("a folder");
            let recordings = Recordings::new(folder.path().join("state"));
            let notes = || fs::read_dir(folder.path().join("state")).map_or(0, Iterator::count);
            let film = folder.path().join("dance.mp4");
            // As a crash does: the lock goes, the file stays.
            let crash = |since_ms| {
                let job = Job { since_ms, ..Job::new(&film, &Project::default(), false) };
                let running = recordings.begin(&job).expect("noted");
                let (path, text) = (running.path.clone(), fs::read(&running.path).expect("a note"));
                drop(running);
                fs::write(path, text).expect("a note");
            };
            let offered = || -> Vec<u64> {
                recordings.interrupted().into_iter().map(|work| work.job.since_ms).collect()
            };
            if has_own_note {
                crash(1);
            }
            crash(2);
            for name in ["dance.mp4.partial", "dance.mp4.partial-before"] {
                fs::write(folder.path().join(name), b"x").expect("a file");
            }
            assert_eq!((offered(), notes()), (vec![2], 1 + usize::from(has_own_note)));
            let discard = || {
                let found = recordings.interrupted();
                lovelock_record::discard_unfinished(&found[0].job.out).expect("discarded");
                found[0].forget();
            };
            discard();
            assert_eq!((offered(), notes()), (vec![if has_own_note { 1 } else { 2 }], 1));
            discard();
            assert_eq!((offered(), notes()), (vec![], 0));
            // Control: of two notes for one film the older one goes.
            crash(3);
            crash(4);
            fs::write(folder.path().join("dance.mp4.partial"), b"x").expect("a file");
            assert_eq!((offered(), notes()), (vec![4], 1));
        }
    }

    #[test]
    fn every_part_of_a_take_is_offered_until_it_is_kept_or_discarded() {
        let folder = tempfile::tempdir().expect("a folder");
        let recordings = Recordings::new(folder.path().join("state"));
        let notes = || fs::read_dir(folder.path().join("state")).map_or(0, Iterator::count);
        let at = |name: &str| folder.path().join(name);
        let fail = |out: &str, since_ms| {
            let job = Job { since_ms, ..Job::new(&at(out), &Project::default(), false) };
            drop(recordings.begin(&job).expect("noted"));
        };
        let offered = || -> Vec<(PathBuf, u64)> {
            recordings.interrupted().into_iter().map(|work| (work.job.out, work.job.since_ms)).collect()
        };
        let (take, cut) = (at("dance.take"), at("dance-cut1.take"));
        // Control: a take that ended well leaves no note, and neither does a recording that put back what an earlier one had left.
        fail("dance.take", 1);
        fs::create_dir(at("frames")).expect("a folder");
        for left in ["film.mp4.partial", "frames/manifest.partial"] {
            fs::write(at(left), b"x").expect("a file");
        }
        let later = date::unix_ms(date::now()) + 3_600_000;
        for out in ["film.mp4", "frames"] {
            fail(out, later);
        }
        assert_eq!(notes(), 0);
        for (out, left) in [("film.mp4", "film.mp4.partial"), ("frames", "frames/manifest.partial")] {
            fail(out, 1);
            assert_eq!(offered(), [(at(out), 1)]);
            fs::remove_file(at(left)).expect("removed");
            assert_eq!((offered().len(), notes()), (0, 0));
        }
        fs::write(at("dance.take.part"), b"x").expect("a file");
        fail("dance.take", 2);
        assert_eq!(offered(), [(take.clone(), 2)]);
        // Recorded again, which renames the part, and interrupted again.
        fs::rename(at("dance.take.part"), at("dance-cut1.take.part")).expect("renamed");
        assert_eq!(offered(), [(cut.clone(), 2)]);
        fs::write(at("dance.take.part"), b"x").expect("a file");
        fail("dance.take", 3);
        assert_eq!(offered(), [(take.clone(), 3), (cut.clone(), 2)]);
        // What is discarded takes no other part along.
        let found = recordings.interrupted();
        fs::remove_file(at("dance.take.part")).expect("removed");
        found[0].forget();
        fs::write(at("dance-cut2.take.part"), b"x").expect("a file");
        let outs = offered().into_iter().map(|(out, _)| out);
        assert_eq!(outs.collect::<BTreeSet<_>>(), BTreeSet::from([cut, at("dance-cut2.take")]));
        for part in ["dance-cut1.take.part", "dance-cut2.take.part"] {
            let found = recordings.interrupted();
            fs::remove_file(at(part)).expect("removed");
            found[0].forget();
        }
        assert!(offered().is_empty());
        assert_eq!(notes(), 0);
    }
}
