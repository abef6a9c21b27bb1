//! The thread that loads, grows and imports, so that the dance goes on meanwhile.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;

use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, StudioError};
use lovelock_project::files::Access;

use super::{Event, Outbox};
use crate::clock::Stopwatch;
use crate::scene::{LoadControl, Scene, SceneLoader};
use crate::take::TakePlayer;

/// What a load has made.
pub(super) enum Loaded {
    /// A scene to simulate, and the project that it was made of.
    Scene(Arc<Scene>, Arc<Project>),
    /// A take to play.
    Take(Box<TakePlayer>),
}

impl Loaded {
    fn scene(&self) -> &Arc<Scene> {
        match self {
            Self::Scene(scene, _) => scene,
            Self::Take(player) => player.scene(),
        }
    }
}

/// How far a load is.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadProgress {
    /// What is being done, such as `making the hair`.
    pub what: String,
    /// The fraction that is done, 0 to 1.
    pub fraction: f32,
    /// How long it has taken until now, seconds.
    pub taken_secs: f64,
}

/// What is being done, the fraction that is done, and since when.
type Progress = Mutex<Option<(String, f32, Stopwatch)>>;

/// What the thread does, and what it is to do next: the latest request wins.
#[derive(Debug, Default)]
struct Desk {
    request: Option<(Arc<Project>, Access)>,
    begun: Option<(Arc<Project>, Access)>,
    stop: bool,
}

/// The thread, and the way to it.
#[derive(Debug)]
pub(super) struct LoadThread {
    desk: Arc<(Mutex<Desk>, Condvar)>,
    cancelled: Arc<AtomicBool>,
    progress: Arc<Progress>,
    thread: Option<JoinHandle<()>>,
}

/// What the thread shares with the rest.
struct Inside {
    desk: Arc<(Mutex<Desk>, Condvar)>,
    cancelled: Arc<AtomicBool>,
    progress: Arc<Progress>,
    outbox: Outbox,
}

impl LoadThread {
    /// Starts the thread; `deliver` is called on it with every scene and take.
    pub(super) fn start(
        outbox: Outbox,
        deliver: impl Fn(Loaded) + Send + 'static,
    ) -> Result<Self, StudioError> {
        let desk = Arc::<(Mutex<Desk>, Condvar)>::default();
        let cancelled = Arc::new(AtomicBool::new(false));
        let progress = Arc::new(Mutex::new(None));
        let inside = Inside {
            desk: Arc::clone(&desk),
            cancelled: Arc::clone(&cancelled),
            progress: Arc::clone(&progress),
            outbox,
        };
        let thread = std::thread::Builder::new()
            .name("lovelock loader".to_owned())
            .spawn(move || inside.run(&deliver))
            .map_err(|error| StudioError::work(format!("the loader thread could not start: {error}")))?;
        Ok(Self { desk, cancelled, progress, thread: Some(thread) })
    }

    /// Asks for the scene of a project. A request that has not begun is replaced. One that has is given up where it reads other
    /// files; otherwise it is seen on the way to this one, since a slider that is dragged asks at every frame.
    pub(super) fn request(&self, project: Arc<Project>, access: Access) {
        let (desk, changed) = &*self.desk;
        let mut desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
        if desk.begun.as_ref().is_some_and(|(begun, by)| *by != access || !same_files(begun, &project)) {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        desk.request = Some((project, access));
        changed.notify_one();
    }

    /// Gives up what is being loaded; the scene stays as it is.
    pub(super) fn cancel(&self) {
        {
            let mut desk = self.desk.0.lock().unwrap_or_else(PoisonError::into_inner);
            desk.request = None;
            self.cancelled.store(true, Ordering::Relaxed);
        }
        // At once for the user's eyes, though the thread may need a moment to notice.
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    /// Whether something is being loaded, or is to be.
    pub(super) fn is_busy(&self) -> bool {
        let desk = self.desk.0.lock().unwrap_or_else(PoisonError::into_inner);
        desk.request.is_some() || desk.begun.is_some()
    }

    /// How far the load is; none where nothing is loaded.
    pub(super) fn progress(&self) -> Option<LoadProgress> {
        let progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        let (what, fraction, since) = progress.as_ref()?;
        Some(LoadProgress { what: what.clone(), fraction: *fraction, taken_secs: since.secs() })
    }
}

/// Whether both projects show what the same files hold.
fn same_files(a: &Project, b: &Project) -> bool {
    let sources = |p: &Project| (p.hair.source, p.body.source, p.motion.source);
    let files = [
        (&a.take.file, &b.take.file),
        (&a.hair.file, &b.hair.file),
        (&a.body.file, &b.body.file),
        (&a.motion.file, &b.motion.file),
    ];
    sources(a) == sources(b) && files.iter().all(|(a, b)| a == b)
}

impl Drop for LoadThread {
    fn drop(&mut self) {
        let (desk, changed) = &*self.desk;
        desk.lock().unwrap_or_else(PoisonError::into_inner).stop = true;
        self.cancelled.store(true, Ordering::Relaxed);
        changed.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Inside {
    fn run(&self, deliver: &dyn Fn(Loaded)) {
        let mut loader = SceneLoader::new();
        while let Some((project, access)) = self.next() {
            let loaded = catch_unwind(AssertUnwindSafe(|| self.load(&mut loader, &project, &access)));
            let replaced = {
                let mut desk = self.desk.0.lock().unwrap_or_else(PoisonError::into_inner);
                desk.begun = None;
                desk.request.is_some()
            };
            // One load after the other is seen as one.
            if !replaced {
                self.show(None);
            }
            match loaded {
                Ok(Ok((loaded, problems))) => {
                    let scene = Arc::clone(loaded.scene());
                    deliver(loaded);
                    self.outbox.send(Event::Loaded { scene, problems });
                }
                Ok(Err(StudioError::Cancelled)) => {
                    // Otherwise it was given up for a later one.
                    if !replaced {
                        self.outbox.send(Event::LoadCancelled);
                    }
                }
                Ok(Err(error)) => self.outbox.send(Event::LoadFailed { message: error.to_string() }),
                Err(panic) => {
                    // What it was in the middle of may be half made.
                    loader = SceneLoader::new();
                    self.outbox.panicked("loader", &*panic);
                }
            }
        }
    }

    /// Waits for a request; none where the thread shall end.
    fn next(&self) -> Option<(Arc<Project>, Access)> {
        let (desk, changed) = &*self.desk;
        let mut desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if desk.stop {
                return None;
            }
            if let Some(request) = desk.request.take() {
                // Under the lock: a cancel after this is meant for this request.
                self.cancelled.store(false, Ordering::Relaxed);
                desk.begun = Some(request.clone());
                return Some(request);
            }
            desk = changed.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn load(
        &self,
        loader: &mut SceneLoader,
        project: &Arc<Project>,
        access: &Access,
    ) -> Result<(Loaded, Vec<Problem>), StudioError> {
        let since = Stopwatch::start();
        let mut progress = |what: &str, fraction: f32| self.show(Some((what.to_owned(), fraction, since)));
        let mut untaken = None;
        if let Some(file) = &project.take.file {
            progress("opening the take", 0.0);
            match access.read(Place::Take, file).map(|path| TakePlayer::open(&path, access)) {
                Ok(Ok(_)) if self.cancelled.load(Ordering::Relaxed) => return Err(StudioError::Cancelled),
                Ok(Ok((player, problems))) => return Ok((Loaded::Take(Box::new(player)), problems)),
                Ok(Err(error)) => untaken = Some(Problem::not_loaded(Place::Take, error)),
                Err(problem) => untaken = Some(problem),
            }
        }
        let (scene, mut problems) = loader.load(
            project,
            access,
            &mut LoadControl { cancelled: &self.cancelled, progress: &mut progress },
        )?;
        problems.extend(untaken.map(|problem| problem.with_fallback("the project is simulated instead")));
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(StudioError::Cancelled);
        }
        Ok((Loaded::Scene(scene, Arc::clone(project)), problems))
    }

    fn show(&self, progress: Option<(String, f32, Stopwatch)>) {
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = progress;
        self.outbox.wake();
    }
}

#[cfg(test)]
mod tests {
    use lovelock_project::files::FileRef;
    use lovelock_project::project::{BodySource, HairSource, MotionSource};

    use super::*;

    #[test]
    fn what_reads_other_files_is_given_up_and_what_only_changes_is_not() {
        let project = Project::default();
        let mut changed = project.clone();
        changed.hair.groom.length *= 0.5;
        changed.body.colliders.field.enabled = false;
        changed.motion.speed = 0.5;
        assert!(same_files(&project, &changed));
        let file = Some(FileRef::new("other"));
        let others: [fn(&mut Project, Option<FileRef>); 7] = [
            |p, file| p.hair.file = file,
            |p, file| p.body.file = file,
            |p, file| p.motion.file = file,
            |p, file| p.take.file = file,
            |p, _| p.hair.source = HairSource::File,
            |p, _| p.body.source = BodySource::File,
            |p, _| p.motion.source = MotionSource::File,
        ];
        for change in others {
            let mut other = project.clone();
            change(&mut other, file.clone());
            assert!(!same_files(&project, &other));
        }
    }
}
