//! The simulation on its own thread, in real time.

mod load_thread;
mod mailbox;
mod simulation_thread;

pub use load_thread::LoadProgress;

use std::any::Any;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use load_thread::LoadThread;
use lovelock_project::Project;
use lovelock_project::error::{Problem, StudioError};
use lovelock_project::files::Access;
use lovelock_record::TakeReport;
use mailbox::{Mailbox, TakeWish};
use simulation_thread::Inside;

use crate::engine::PrerollProgress;
use crate::latest::Slot;
use crate::scene::Scene;
use crate::snapshot::FrameSnapshot;
use crate::take::TakeProgress;

/// Events that may wait for the interface; more are dropped, and logged.
const MOST_EVENTS: usize = 256;

/// Called, from any thread, when there is something new to show: the window repaints.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// What happened meanwhile.
#[derive(Clone, Debug)]
pub enum Event {
    /// A scene is loaded, and dances from the next frame on.
    Loaded {
        /// The scene, with the notes of its files.
        scene: Arc<Scene>,
        /// What could not be loaded.
        problems: Vec<Problem>,
    },
    /// A load was given up; the scene stays as it was.
    LoadCancelled,
    /// Nothing could be loaded; the scene stays as it was.
    LoadFailed {
        /// Why.
        message: String,
    },
    /// A motion that does not loop came to its end, and playing has paused.
    EndReached,
    /// A take is whole and has its name.
    TakeSaved {
        /// What was recorded.
        report: TakeReport,
        /// Why it ended by itself, where it did.
        because: Option<String>,
    },
    /// A take could not be recorded; what is kept of it, the message says.
    TakeFailed {
        /// Why.
        message: String,
    },
    /// The take that plays has a place that cannot be read; the instant before it stays.
    TakeUnreadable {
        /// Why.
        message: String,
    },
    /// A thread met a defect of the program and caught itself. The scene goes on; save the project.
    Panicked {
        /// Which thread.
        thread: &'static str,
        /// What it said.
        message: String,
    },
}

/// The way from the threads to the interface.
#[derive(Clone)]
pub(super) struct Outbox {
    events: SyncSender<Event>,
    wake: Wake,
}

impl Outbox {
    /// With where its events come out.
    pub(super) fn new(wake: Wake) -> (Self, Receiver<Event>) {
        let (events, received) = sync_channel(MOST_EVENTS);
        (Self { events, wake }, received)
    }

    pub(super) fn send(&self, event: Event) {
        if let Err(TrySendError::Full(event)) = self.events.try_send(event) {
            tracing::warn!(?event, "the interface does not read its events: one is dropped");
        }
        self.wake();
    }

    pub(super) fn panicked(&self, thread: &'static str, panic: &(dyn Any + Send)) {
        let message = panic
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned())
            .or_else(|| panic.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "no message".to_owned());
        tracing::error!(thread, message, "a thread panicked");
        self.send(Event::Panicked { thread, message });
    }

    pub(super) fn wake(&self) {
        (self.wake)();
    }
}

/// The simulation thread and the loader thread. Dropping it ends both.
///
/// No call waits: wishes are left in a box where later ones replace earlier ones, and the newest frame lies in a
/// slot where the latest wins.
pub struct Worker {
    mailbox: Mailbox,
    frames: Slot<FrameSnapshot>,
    events: Mutex<Receiver<Event>>,
    loader: Arc<LoadThread>,
    recorded: Arc<Mutex<Option<TakeProgress>>>,
    settling: Arc<Mutex<Option<PrerollProgress>>>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts both threads on a project, playing. The first frame appears when the scene is loaded.
    ///
    /// # Errors
    /// Where the system gives no threads.
    pub fn start(project: Arc<Project>, access: Access, wake: Wake) -> Result<Self, StudioError> {
        let (outbox, events) = Outbox::new(wake);
        let mailbox = Mailbox::default();
        let frames = Slot::default();
        let to_simulation = mailbox.clone();
        let loader = Arc::new(LoadThread::start(outbox.clone(), move |loaded| {
            to_simulation.ask(|wishes| wishes.loaded = Some(loaded));
        })?);
        mailbox.ask(|wishes| wishes.project = Some((project, access)));
        let (recorded, settling) = (Arc::default(), Arc::default());
        let inside = Inside::new(
            mailbox.clone(),
            frames.clone(),
            Arc::clone(&loader),
            outbox,
            Arc::clone(&recorded),
            Arc::clone(&settling),
        );
        let thread = std::thread::Builder::new()
            .name("lovelock simulation".to_owned())
            .spawn(move || inside.run())
            .map_err(|error| StudioError::work(format!("the simulation thread could not start: {error}")))?;
        Ok(Self {
            mailbox,
            frames,
            events: Mutex::new(events),
            loader,
            recorded,
            settling,
            thread: Some(thread),
        })
    }

    /// The project has changed. What needs loading is loaded aside; the old scene dances on meanwhile.
    pub fn set_project(&self, project: Arc<Project>, access: Access) {
        self.mailbox.ask(|wishes| wishes.project = Some((project, access)));
    }

    /// Plays or pauses.
    pub fn set_playing(&self, playing: bool) {
        self.mailbox.ask(|wishes| wishes.playing = Some(playing));
    }

    /// Seconds of the scene a second, 0.05 to 2: slow motion.
    pub fn set_rate(&self, rate: f64) {
        self.mailbox.ask(|wishes| wishes.rate = Some(rate));
    }

    /// How many pictures the display shows in a second: on one of more than 60, and in slow motion, what is seen lies between two
    /// steps, so that it moves evenly.
    pub fn set_display_hz(&self, hz: f64) {
        self.mailbox.ask(|wishes| wishes.display_hz = Some(hz));
    }

    /// Whether a take plays from its end to its start; a simulation only goes on.
    pub fn set_backwards(&self, backwards: bool) {
        self.mailbox.ask(|wishes| wishes.backwards = Some(backwards));
    }

    /// Records every step from now on as a take, until [`Worker::finish_take`]. A disk that fails comes as an event.
    pub fn record_take(&self, path: impl Into<PathBuf>) {
        let path = path.into();
        self.mailbox.ask(|wishes| wishes.take = Some(TakeWish::Start(path)));
    }

    /// Makes the take that is recorded whole.
    pub fn finish_take(&self) {
        self.mailbox.ask(|wishes| wishes.take = Some(TakeWish::Finish));
    }

    /// How far the take is that is recorded; none where none is.
    pub fn take_progress(&self) -> Option<TakeProgress> {
        self.recorded.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// How far the hair is that settles where one has gone to; none where it is settled.
    pub fn settling(&self) -> Option<PrerollProgress> {
        *self.settling.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Goes on with the hair as it is, not settled.
    pub fn cancel_settle(&self) {
        self.mailbox.ask(|wishes| wishes.settle = Some(false));
    }

    /// Goes to a time, seconds; the hair moves along at once, and settles there aside. Time waits for it.
    pub fn seek(&self, time_secs: f64) {
        self.mailbox.ask(|wishes| {
            (wishes.seek_secs, wishes.look_back) = (Some(time_secs), false);
            (wishes.steps, wishes.restart) = (0, false);
        });
    }

    /// As [`Worker::seek`], to look at what was measured there: the totals go on from those of before.
    pub fn look_back(&self, time_secs: f64) {
        self.mailbox.ask(|wishes| {
            (wishes.seek_secs, wishes.look_back) = (Some(time_secs), true);
            (wishes.steps, wishes.restart) = (0, false);
        });
    }

    /// Goes on by a number of steps of 1/60 s, or back. On, the hair is simulated; back, it settles as for [`Worker::seek`].
    pub fn step(&self, steps: i64) {
        self.mailbox.ask(|wishes| wishes.steps = wishes.steps.saturating_add(steps).clamp(-600, 600));
    }

    /// To the first frame, the hair settled.
    pub fn restart(&self) {
        self.mailbox.ask(|wishes| {
            wishes.restart = true;
            (wishes.seek_secs, wishes.steps) = (None, 0);
        });
    }

    /// Lets the hair fall into place where it is.
    pub fn settle(&self) {
        self.mailbox.ask(|wishes| wishes.settle = Some(true));
    }

    /// Gives up what is being loaded.
    pub fn cancel_load(&self) {
        self.loader.cancel();
    }

    /// Dances a scene that no loader has made.
    #[cfg(test)]
    pub(crate) fn put_scene(&self, scene: Arc<Scene>) {
        let project = Arc::new(Project::default());
        self.mailbox.ask(|wishes| wishes.loaded = Some(load_thread::Loaded::Scene(scene, project)));
    }

    /// How far a load is; none where nothing is loaded.
    pub fn load_progress(&self) -> Option<LoadProgress> {
        self.loader.progress()
    }

    /// The newest frame; none before the first scene is loaded.
    pub fn frame(&self) -> Option<Arc<FrameSnapshot>> {
        self.frames.latest()
    }

    /// The slot that frames are left in.
    pub fn frames(&self) -> &Slot<FrameSnapshot> {
        &self.frames
    }

    /// The next thing that happened, oldest first.
    pub fn poll_event(&self) -> Option<Event> {
        self.events.lock().unwrap_or_else(PoisonError::into_inner).try_recv().ok()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.mailbox.ask(|wishes| wishes.stop = true);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests;
