//! The loader thread: loads, grows and imports in the background.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;

use lovelock_base::clock::Stopwatch;
use lovelock_base::watch::Watch;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProjectError};
use lovelock_project::files::Access;

use super::{Event, Outbox};
use crate::aside::aside;
use crate::memory::Held;
use crate::scene::{LoadControl, Scene, SceneLoader, SurroundingsLoader};
use crate::take::TakePlayer;
use crate::threads::own_workers;

/// The result of a load.
pub(super) enum Loaded {
    /// A scene to simulate, and the project that it was loaded from.
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

/// Progress of a load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadProgress {
    /// The current work, such as `creating the hair`.
    pub what: String,
    /// The fraction that is done, 0 to 1.
    pub fraction: f32,
    /// Elapsed time, seconds.
    pub taken_secs: f64,
}

/// The current work, the fraction that is done, and the start time.
type Progress = Mutex<Option<(String, f32, Stopwatch)>>;

/// The current and the next request of the thread. A later request replaces the next one.
#[derive(Debug, Default)]
struct Requests {
    request: Option<(Arc<Project>, Access)>,
    begun: Option<(Arc<Project>, Access)>,
    /// Whether a request was cancelled before it began, which the thread still has to tell.
    dropped: bool,
    stop: bool,
}

/// Handle of the loader thread.
#[derive(Debug)]
pub(super) struct LoadThread {
    requests: Arc<(Mutex<Requests>, Condvar)>,
    cancelled: Arc<AtomicBool>,
    progress: Arc<Progress>,
    layers: Held,
    thread: Option<JoinHandle<()>>,
}

/// What has been loaded, for reuse.
#[derive(Default)]
struct Loaders {
    scene: SceneLoader,
    /// For takes, whose scenes have loaders of their own.
    surroundings: SurroundingsLoader,
}

/// The state on the thread.
struct LoadState {
    requests: Arc<(Mutex<Requests>, Condvar)>,
    cancelled: Arc<AtomicBool>,
    progress: Arc<Progress>,
    layers: Held,
    outbox: Outbox,
}

impl LoadThread {
    /// Starts the thread, which passes every scene and take to `deliver`.
    pub(super) fn start(
        outbox: Outbox,
        deliver: impl Fn(Loaded) + Send + 'static,
    ) -> Result<Self, ProjectError> {
        let requests = Arc::<(Mutex<Requests>, Condvar)>::default();
        let cancelled = Arc::new(AtomicBool::new(false));
        let (progress, layers) = (Arc::new(Mutex::new(None)), Held::default());
        let inside = LoadState {
            requests: Arc::clone(&requests),
            cancelled: Arc::clone(&cancelled),
            progress: Arc::clone(&progress),
            layers: layers.clone(),
            outbox,
        };
        let thread = std::thread::Builder::new()
            .name("lovelock loader".to_owned())
            .spawn(move || inside.run(&deliver))
            .map_err(|error| ProjectError::work(format!("the loader thread could not start: {error}")))?;
        Ok(Self { requests, cancelled, progress, layers, thread: Some(thread) })
    }

    /// A handle of a load of `project` that never ends.
    #[cfg(test)]
    pub(super) fn that_never_ends(project: Arc<Project>) -> Self {
        let begun = Some((project, Access::new()));
        let requests = Requests { begun, ..Requests::default() };
        Self {
            requests: Arc::new((Mutex::new(requests), Condvar::new())),
            cancelled: Arc::default(),
            progress: Arc::default(),
            layers: Held::default(),
            thread: None,
        }
    }

    /// Requests the scene of a project. A request that has not started is replaced. A running one is cancelled if it reads other
    /// files; otherwise it is completed and shown, because a dragged slider sends a request at every frame.
    pub(super) fn request(&self, project: Arc<Project>, access: Access) {
        let (requests, changed) = &*self.requests;
        let mut requests = requests.lock().unwrap_or_else(PoisonError::into_inner);
        if requests.begun.as_ref().is_some_and(|(begun, by)| *by != access || !same_files(begun, &project)) {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        requests.request = Some((project, access));
        // From now on there is something to wait for, however soon it begins.
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.get_or_insert_with(|| ("loading".to_owned(), 0.0, Stopwatch::start()));
        changed.notify_one();
    }

    /// Ends the progress of a load whose result is in use, unless another load runs or waits.
    pub(super) fn arrived(&self) {
        let requests = self.requests.0.lock().unwrap_or_else(PoisonError::into_inner);
        if requests.request.is_none() && requests.begun.is_none() {
            *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = None;
        }
    }

    /// Cancels the current load; the scene is unchanged.
    pub(super) fn cancel(&self) {
        {
            let mut requests = self.requests.0.lock().unwrap_or_else(PoisonError::into_inner);
            let was_waiting = requests.request.take().is_some();
            requests.dropped |= was_waiting && requests.begun.is_none();
            self.cancelled.store(true, Ordering::Relaxed);
        }
        self.requests.1.notify_one();
        // Clear the progress at once, although the thread may need a moment to stop.
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    /// Whether a load is running or waiting.
    pub(super) fn is_busy(&self) -> bool {
        let requests = self.requests.0.lock().unwrap_or_else(PoisonError::into_inner);
        requests.request.is_some() || requests.begun.is_some()
    }

    /// The memory of the hairstyles that are kept between layers, bytes.
    pub(super) fn layer_bytes(&self) -> u64 {
        self.layers.bytes()
    }

    /// Progress of the current load, if any.
    pub(super) fn progress(&self) -> Option<LoadProgress> {
        let progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        let (what, fraction, since) = progress.as_ref()?;
        Some(LoadProgress { what: what.clone(), fraction: *fraction, taken_secs: since.secs() })
    }
}

/// Whether both projects use the same files.
fn same_files(a: &Project, b: &Project) -> bool {
    let sources = |p: &Project| (p.hair.source, p.body.source, p.motion.source);
    let files = [
        (&a.take.file, &b.take.file),
        (&a.hair.file, &b.hair.file),
        (&a.body.file, &b.body.file),
        (&a.motion.file, &b.motion.file),
        (&a.surroundings.file, &b.surroundings.file),
        (&a.surroundings.backdrop, &b.surroundings.backdrop),
    ];
    sources(a) == sources(b) && files.iter().all(|(a, b)| a == b)
}

impl Drop for LoadThread {
    fn drop(&mut self) {
        let (requests, changed) = &*self.requests;
        requests.lock().unwrap_or_else(PoisonError::into_inner).stop = true;
        self.cancelled.store(true, Ordering::Relaxed);
        changed.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl LoadState {
    fn run(&self, deliver: &dyn Fn(Loaded)) {
        let mut loaders = Loaders::default();
        let threads = own_workers("load");
        while let Some((project, access)) = self.next() {
            let loaded = catch_unwind(AssertUnwindSafe(|| match &threads {
                Some(threads) => threads.install(|| self.load(&mut loaders, &project, &access)),
                None => self.load(&mut loaders, &project, &access),
            }));
            self.layers.set(loaders.scene.layer_bytes());
            let replaced = {
                let mut requests = self.requests.0.lock().unwrap_or_else(PoisonError::into_inner);
                requests.begun = None;
                let replaced = requests.request.is_some();
                // Successive loads are shown as one, and a result until it is in use.
                let is_used = matches!(loaded, Ok(Ok(_))) && !self.cancelled.load(Ordering::Relaxed);
                let since = if replaced { Stopwatch::start() } else { self.since() };
                let placing = ("placing the hair".to_owned(), 1.0, since);
                *self.progress.lock().unwrap_or_else(PoisonError::into_inner) =
                    (replaced || is_used).then_some(placing);
                replaced
            };
            self.outbox.wake();
            match loaded {
                Ok(Ok((loaded, problems))) => {
                    let scene = Arc::clone(loaded.scene());
                    deliver(loaded);
                    self.outbox.send(Event::Loaded { scene, problems, project });
                }
                Ok(Err(ProjectError::Cancelled)) => {
                    // Otherwise a later request replaced it.
                    if !replaced {
                        self.outbox.send(Event::LoadCancelled);
                    }
                }
                Ok(Err(error)) => self.outbox.send(Event::LoadFailed { message: error.to_string() }),
                Err(panic) => {
                    // Its cached parts may be incomplete.
                    loaders = Loaders::default();
                    self.outbox.panicked("loader", &*panic);
                }
            }
        }
    }

    /// Waits for a request; `None` when the thread must end.
    fn next(&self) -> Option<(Arc<Project>, Access)> {
        let (requests, changed) = &*self.requests;
        let mut requests = requests.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if requests.stop {
                return None;
            }
            if std::mem::take(&mut requests.dropped) {
                drop(requests);
                self.outbox.send(Event::LoadCancelled);
                requests = self.requests.0.lock().unwrap_or_else(PoisonError::into_inner);
                continue;
            }
            if let Some(request) = requests.request.take() {
                // Under the lock, so that a later cancel applies to this request.
                self.cancelled.store(false, Ordering::Relaxed);
                requests.begun = Some(request.clone());
                return Some(request);
            }
            requests = changed.wait(requests).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn load(
        &self,
        loaders: &mut Loaders,
        project: &Arc<Project>,
        access: &Access,
    ) -> Result<(Loaded, Vec<Problem>), ProjectError> {
        let since = self.since();
        let mut progress = |what: &str, fraction: f32| self.show(what, fraction, since);
        let mut untaken = None;
        if let Some(file) = &project.take.file {
            progress("opening the take", 0.0);
            let opened = match access.read(Place::Take, file) {
                Ok(path) => {
                    let (access, project) = (access.clone(), Arc::clone(project));
                    let mut tick = |done| progress("opening the take", 0.9 * done);
                    let open = move |_: &Watch| TakePlayer::open_for(&path, &access, &project);
                    Ok(aside(&self.cancelled, &mut tick, open)?)
                }
                Err(problem) => Err(problem),
            };
            match opened {
                Ok(Ok((mut player, mut problems))) => {
                    progress("loading the surroundings", 0.9);
                    let light = &mut loaders.surroundings;
                    player.set_surroundings(light.load(project, access, &mut problems), light.notes());
                    return Ok((Loaded::Take(Box::new(player)), problems));
                }
                Ok(Err(error)) => untaken = Some(Problem::not_loaded(Place::Take, error)),
                Err(problem) => untaken = Some(problem),
            }
        }
        let (scene, mut problems) = loaders.scene.load(
            project,
            access,
            &mut LoadControl { cancelled: &self.cancelled, progress: &mut progress },
        )?;
        problems.extend(untaken.map(|problem| problem.with_fallback("the project is simulated instead")));
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(ProjectError::Cancelled);
        }
        Ok((Loaded::Scene(scene, Arc::clone(project)), problems))
    }

    /// Since when the load was asked for.
    fn since(&self) -> Stopwatch {
        let progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.as_ref().map_or_else(Stopwatch::start, |(.., since)| *since)
    }

    fn show(&self, what: &str, fraction: f32, since: Stopwatch) {
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) =
            Some((what.to_owned(), fraction, since));
        self.outbox.wake();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;
    use std::sync::mpsc::sync_channel;
    use std::time::Duration;

    use lovelock_project::files::FileRef;
    use lovelock_project::project::{BodySource, HairSource, MotionSource};
    use lovelock_style::Layer;
    use lovelock_style::operations::Curl;
    use lovelock_testkit::wait::wait_for;

    use super::*;
    use crate::testing::small_project;

    #[test]
    fn a_load_has_progress_from_the_request_until_its_result_is_in_use() {
        let (outbox, _events) = Outbox::new(Arc::new(|| ()));
        let (to, results) = sync_channel(16);
        let loader = LoadThread::start(outbox, move |loaded| drop(to.send(loaded))).expect("a thread");
        assert_eq!(loader.progress(), None);
        let mut project = small_project();
        for tie in [false, true] {
            if tie {
                project.hair.ties.push(lovelock_groom::HairTie::default());
            }
            loader.request(Arc::new(project.clone()), Access::new());
            // Whether or not the thread has begun it, or is done with it.
            assert!(loader.progress().is_some(), "{tie}");
            let _result = wait_for("a result", || results.try_recv().ok());
            let progress = loader.progress().expect("nobody uses the result yet");
            assert_eq!(progress.fraction.to_bits(), 1.0_f32.to_bits(), "{progress:?}");
            loader.arrived();
            assert_eq!(loader.progress(), None, "{tie}");
        }
        // A load that is cancelled has none.
        project.hair.ties.clear();
        loader.request(Arc::new(project), Access::new());
        loader.cancel();
        wait_for("its end", || (!loader.is_busy()).then_some(()));
        loader.arrived();
        assert_eq!(loader.progress(), None);
    }

    /// Keeps the workers that images have in common busy until it is dropped.
    struct BusyWorkers(Arc<AtomicBool>);

    impl BusyWorkers {
        fn new() -> Self {
            let (busy, free) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
            let held = Self(Arc::clone(&free));
            let workers = rayon::current_num_threads();
            for _ in 0..workers {
                let (busy, free) = (Arc::clone(&busy), Arc::clone(&free));
                rayon::spawn(move || {
                    busy.fetch_add(1, Ordering::Relaxed);
                    while !free.load(Ordering::Relaxed) {
                        std::thread::sleep(Duration::from_millis(1));
                    }
                });
            }
            wait_for("busy workers", || (busy.load(Ordering::Relaxed) == workers).then_some(()));
            held
        }
    }

    impl Drop for BusyWorkers {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }

    #[test]
    fn a_layer_does_not_wait_for_what_draws() {
        let (outbox, _events) = Outbox::new(Arc::new(|| ()));
        let (to, results) = sync_channel(16);
        let loader = LoadThread::start(outbox, move |loaded| drop(to.send(loaded))).expect("a thread");
        let mut project = small_project();
        project.hair.stack.push(Layer::of(Curl::default()));
        loader.request(Arc::new(project.clone()), Access::new());
        let first = wait_for("a scene", || results.try_recv().ok());
        project.hair.stack.layers[0].weight = 0.3;
        let busy = BusyWorkers::new();
        // Control: other work of the common pool waits.
        let done = Arc::new(AtomicBool::new(false));
        let told = Arc::clone(&done);
        rayon::spawn(move || told.store(true, Ordering::Relaxed));
        loader.request(Arc::new(project), Access::new());
        let second = wait_for("the changed layer", || results.try_recv().ok());
        assert!(!done.load(Ordering::Relaxed), "the workers were busy all the time");
        drop(busy);
        assert!(!Arc::ptr_eq(&first.scene().style, &second.scene().style));
        wait_for("the workers", || done.load(Ordering::Relaxed).then_some(()));
    }

    #[test]
    fn loads_of_other_files_are_cancelled_and_loads_of_changes_are_not() {
        let project = Project::default();
        let mut changed = project.clone();
        changed.hair.groom.length *= 0.5;
        changed.body.colliders.field.enabled = false;
        changed.motion.speed = 0.5;
        assert!(same_files(&project, &changed));
        let file = Some(FileRef::new("other"));
        let others: [fn(&mut Project, Option<FileRef>); 8] = [
            |p, file| p.hair.file = file,
            |p, file| p.body.file = file,
            |p, file| p.motion.file = file,
            |p, file| p.surroundings.file = file,
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
