//! Files that the user opens: what they are is found out on a thread, because a large one takes seconds to read.

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_base::watch::Watch;
use lovelock_base::words::counted;
use lovelock_groom::CurveMotion;
use lovelock_jobs::info::FileKind;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProjectError};
use lovelock_project::files::Access;
use lovelock_project::project::HairSection;
use lovelock_session::progress::Progress;
use lovelock_session::strokes::{PlayStrokes, play_strokes, read_strokes};
use lovelock_session::take::{CurvesToPlay, project_of_take};
use lovelock_session::threads::background_workers;

/// How often strokes that wait for others look whether it is their turn, or whether they were cancelled.
const LOOK: Duration = Duration::from_millis(20);

/// What a file is.
pub(super) enum Found {
    /// A project or a style, which are small, or strokes that are not to be played.
    Document(FileKind),
    /// A part of the project, and a sentence about what of it is not used.
    Part(FileKind, Option<String>),
    /// A take: its project, with problems.
    Take(Box<Project>, Vec<Problem>),
    /// Curves over time.
    Curves(CurvesToPlay),
    /// Strokes that were played in a new project.
    Strokes(Arc<Played>),
}

impl Found {
    /// Looks into a file. Curves are read in the unit and up axis of `hair`. Strokes are played on the hair of `new`, if there is one; `watch`
    /// has their progress and cancels them.
    pub(super) fn of(
        path: &Path,
        hair: &HairSection,
        new: Option<&Project>,
        watch: &Watch,
    ) -> Result<Self, ProjectError> {
        Ok(match FileKind::of(path)? {
            kind @ (FileKind::Project | FileKind::Style) => Self::Document(kind),
            FileKind::Take => {
                let (project, problems) = project_of_take(path)?;
                Self::Take(Box::new(project), problems)
            }
            FileKind::Hair => match CurveMotion::of(path) {
                CurveMotion::Moving(_) => Self::Curves(CurvesToPlay::read(path, hair)?),
                motion => Self::Part(FileKind::Hair, motion.problem()),
            },
            FileKind::Strokes => match new {
                Some(new) => Self::Strokes(Arc::new(Played::of(path, new, watch)?)),
                None => Self::Document(FileKind::Strokes),
            },
            kind => Self::Part(kind, None),
        })
    }

    /// The name of its kind in sentences.
    pub(super) fn label(&self) -> &'static str {
        match self {
            Self::Document(kind) | Self::Part(kind, _) => kind.label(),
            Self::Take(..) => FileKind::Take.label(),
            Self::Curves(_) => FileKind::Hair.label(),
            Self::Strokes(_) => FileKind::Strokes.label(),
        }
    }
}

/// Strokes that were played on the hair of a new project. The file stays as it is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Played {
    /// The project with them.
    pub(super) project: Project,
    /// What of the project could not be loaded.
    pub(super) problems: Vec<Problem>,
    /// What was done, in a sentence.
    pub(super) said: String,
}

impl Played {
    /// Plays the strokes in a file on the hair of a project.
    pub(super) fn of(path: &Path, new: &Project, watch: &Watch) -> Result<Self, ProjectError> {
        let strokes = read_strokes(path)?;
        let mut follow = |progress: Progress| {
            let done = match progress {
                Progress::Simulating { done, total } => done as f32 / total.max(1) as f32,
                _ => 0.0,
            };
            if watch.at(done).is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let mut play = || play_strokes(new, &Access::new(), &strokes, PlayStrokes::default(), &mut follow);
        let _turn = turn(watch)?;
        let played = match background_workers("strokes") {
            Some(workers) => workers.install(play),
            None => play(),
        };
        let (project, report, problems) = played?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let missed = match report.missed {
            0 => String::new(),
            missed => format!("; {} no hair", counted(missed, "stroke touched", "strokes touched")),
        };
        let count = counted(report.strokes, "stroke", "strokes");
        Ok(Self { project, problems, said: format!("Played {count} of {name} as a new project{missed}.") })
    }
}

/// Waits until no other strokes are played: each simulation uses every processor and has a scene of its own.
fn turn(watch: &Watch) -> Result<MutexGuard<'static, ()>, ProjectError> {
    static TURN: Mutex<()> = Mutex::new(());
    loop {
        match TURN.try_lock() {
            Ok(turn) => return Ok(turn),
            Err(TryLockError::Poisoned(turn)) => return Ok(turn.into_inner()),
            Err(TryLockError::WouldBlock) => watch.at(0.0).map_err(|_| ProjectError::Cancelled)?,
        }
        std::thread::sleep(LOOK);
    }
}

/// What a file is opened for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aim {
    /// To become the project, or a part of it.
    Open,
    /// As `Open`, because the command line names it: an error is printed too.
    Start,
    /// To play the take that was recorded last, in the same project.
    PlayTake,
    /// For a pane beside the project.
    Beside,
    /// To become this part of the project.
    Part(Place),
}

/// A file that was looked into.
pub(super) struct Opened {
    pub(super) path: PathBuf,
    pub(super) aim: Aim,
    pub(super) found: Result<Found, ProjectError>,
}

struct Opening {
    path: PathBuf,
    aim: Aim,
    found: Receiver<Result<Found, ProjectError>>,
    since: Stopwatch,
    reader: Reader,
}

/// The watch of a thread that looks into a file. The thread stops when nobody waits for the file any more.
struct Reader(Watch);

impl Drop for Reader {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

/// The files that are looked into, in the order in which the user opened them.
#[derive(Default)]
pub(super) struct Openings(VecDeque<Opening>);

impl Openings {
    /// Looks into a file on a thread of its own, which requests a repaint at its end. Strokes are played on the hair of `new`, if there is one.
    pub(super) fn start(
        &mut self,
        path: &Path,
        aim: Aim,
        (hair, new): (HairSection, Option<Arc<Project>>),
        ctx: &egui::Context,
    ) -> std::io::Result<()> {
        let (sender, found) = sync_channel(1);
        let (file, wake, watch) = (path.to_owned(), ctx.clone(), Watch::default());
        let reader = Reader(watch.clone());
        std::thread::Builder::new().name("lovelock file".to_owned()).spawn(move || {
            // The window may be closed already, or the user may have lost patience.
            let _ = sender.send(Found::of(&file, &hair, new.as_deref(), &watch));
            super::images::wake(&wake);
        })?;
        self.0.push_back(Opening { path: path.to_owned(), aim, found, since: Stopwatch::start(), reader });
        Ok(())
    }

    /// The first file, if it was looked into.
    pub(super) fn next(&mut self) -> Option<Opened> {
        let found = match self.0.front()?.found.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Ok(found) => found,
            Err(TryRecvError::Disconnected) => Err(ProjectError::work(
                "the file could not be opened because of an internal error in its reader",
            )),
        };
        let Opening { path, aim, .. } = self.0.pop_front()?;
        Some(Opened { path, aim, found })
    }

    /// The name of the file that is looked into, and since when, seconds.
    pub(super) fn running(&self) -> Option<(String, f64)> {
        let first = self.0.front()?;
        let name = first.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Some((name, first.since.secs()))
    }

    /// The part of that file that is done, 0 to 1.
    pub(super) fn done(&self) -> f32 {
        self.0.front().map_or(0.0, |first| first.reader.0.done())
    }

    /// Does not open the file that [`Self::running`] names. Its thread ends by itself.
    pub(super) fn cancel_first(&mut self) {
        self.0.pop_front();
    }

    /// Does not open the file for which a dialog is open. Its thread ends by itself.
    pub(super) fn cancel_asked(&mut self, path: &Path) {
        if let Some(at) = self.0.iter().rposition(|opening| opening.path == path) {
            self.0.remove(at);
        }
    }

    /// Opens none of the files. Their threads end by themselves.
    pub(super) fn cancel(&mut self) {
        self.0.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_are_played_one_file_at_a_time_and_those_that_wait_can_be_cancelled() {
        let watch = Watch::default();
        let first = turn(&Watch::default()).expect("a turn");
        std::thread::scope(|scope| {
            let second = scope.spawn(|| turn(&watch).map(drop));
            std::thread::sleep(2 * LOOK);
            assert!(!second.is_finished(), "it waits");
            watch.cancel();
            assert!(matches!(second.join().expect("its result"), Err(ProjectError::Cancelled)));
        });
        drop(first);
        // Control: nobody is cancelled.
        assert!(turn(&Watch::default()).is_ok());
    }
}
