//! The simulation on a thread of its own, in real time, and the loader thread.

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
use lovelock_brush::StrokeSample;
use lovelock_project::Project;
use lovelock_project::error::{Problem, ProjectError};
use lovelock_project::files::Access;
use lovelock_record::TakeReport;
use mailbox::{BrushRequest, Mailbox, TakeRequest};
use simulation_thread::SimulationThread;

use crate::engine::PrerollProgress;
use crate::latest::Latest;
use crate::memory::Held;
use crate::scene::Scene;
use crate::snapshot::FrameSnapshot;
use crate::strokes::{StrokeReport, StrokeStart};
use crate::take::TakeProgress;
use crate::window_device::WindowDevice;

/// Maximum number of unread events; more are dropped and logged.
const MAX_EVENTS: usize = 256;

/// Called from any thread when there is something new to show, so that the window repaints.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// An event on one of the threads.
#[derive(Clone, Debug)]
pub enum Event {
    /// A scene was loaded and is used from the next frame on.
    Loaded {
        /// The scene, including the notes about its files.
        scene: Arc<Scene>,
        /// What could not be loaded.
        problems: Vec<Problem>,
        /// The project that it was loaded from.
        project: Arc<Project>,
    },
    /// A load was cancelled; the scene is unchanged.
    LoadCancelled,
    /// Nothing could be loaded; the scene is unchanged.
    LoadFailed {
        /// The reason.
        message: String,
    },
    /// A motion without loop reached its end, and playback has paused.
    EndReached,
    /// A take is complete and has its final name.
    TakeSaved {
        /// The recorded take.
        report: TakeReport,
        /// Why recording ended by itself, if it did.
        because: Option<String>,
    },
    /// Recording a take failed; the message says which part is kept.
    TakeFailed {
        /// The reason.
        message: String,
    },
    /// A stroke of a brush has changed the hair.
    Brushed(StrokeReport),
    /// A part of the played take cannot be read; the previous frame stays visible.
    TakeUnreadable {
        /// The reason.
        message: String,
    },
    /// A thread panicked and recovered. The scene continues; the user should save the project.
    Panicked {
        /// Which thread.
        thread: &'static str,
        /// The panic message.
        message: String,
    },
}

/// Sends events from the threads to the interface.
#[derive(Clone)]
pub(super) struct Outbox {
    events: SyncSender<Event>,
    wake: Wake,
}

impl Outbox {
    /// Also returns the receiver of the events.
    pub(super) fn new(wake: Wake) -> (Self, Receiver<Event>) {
        let (events, received) = sync_channel(MAX_EVENTS);
        (Self { events, wake }, received)
    }

    pub(super) fn send(&self, event: Event) {
        if let Err(TrySendError::Full(event)) = self.events.try_send(event) {
            tracing::warn!(?event, "the interface does not read its events; one was dropped");
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

/// What the simulation thread shares with the worker that controls it.
#[derive(Clone)]
struct Shared {
    mailbox: Mailbox,
    frames: Latest<FrameSnapshot>,
    loader: Arc<LoadThread>,
    recorded: Arc<Mutex<Option<TakeProgress>>>,
    settling: Arc<Mutex<Option<PrerollProgress>>>,
    take_frames: Held,
}

impl Shared {
    fn new(mailbox: Mailbox, loader: Arc<LoadThread>) -> Self {
        Self {
            mailbox,
            frames: Latest::default(),
            loader,
            recorded: Arc::default(),
            settling: Arc::default(),
            take_frames: Held::default(),
        }
    }
}

/// The simulation thread and the loader thread. Dropping it ends both.
///
/// No call blocks: later requests replace earlier ones in a mailbox, and only the newest frame is kept.
pub struct Worker {
    shared: Shared,
    events: Mutex<Receiver<Event>>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts both threads with a project, in playback. The first frame appears when the scene is loaded. Hair that a graphics card
    /// simulates is simulated on the device of the window, where it is drawn.
    ///
    /// # Errors
    /// If the system cannot create threads.
    pub fn start(
        project: Arc<Project>,
        access: Access,
        window: &WindowDevice,
        wake: Wake,
    ) -> Result<Self, ProjectError> {
        let (outbox, events) = Outbox::new(wake);
        let mailbox = Mailbox::default();
        let to_simulation = mailbox.clone();
        let loader = Arc::new(LoadThread::start(outbox.clone(), move |loaded| {
            to_simulation.post(|requests| requests.loaded = Some(loaded));
        })?);
        mailbox.post(|requests| requests.project = Some((project, access)));
        let shared = Shared::new(mailbox, loader);
        let inside = SimulationThread::new(shared.clone(), outbox, window.clone());
        let thread = std::thread::Builder::new()
            .name("lovelock simulation".to_owned())
            .spawn(move || inside.run())
            .map_err(|error| ProjectError::work(format!("the simulation thread could not start: {error}")))?;
        Ok(Self { shared, events: Mutex::new(events), thread: Some(thread) })
    }

    /// Sets a changed project. Parts that need loading are loaded in the background while the old scene continues.
    pub fn set_project(&self, project: Arc<Project>, access: Access) {
        self.shared.mailbox.post(|requests| requests.project = Some((project, access)));
    }

    /// Plays or pauses.
    pub fn set_playing(&self, playing: bool) {
        self.shared.mailbox.post(|requests| requests.playing = Some(playing));
    }

    /// Sets the scene seconds per second, 0.05 to 2; less than 1 is slow motion.
    pub fn set_rate(&self, rate: f64) {
        self.shared.mailbox.post(|requests| requests.rate = Some(rate));
    }

    /// Sets the refresh rate of the display. Above 60 Hz and in slow motion, images are interpolated between two steps, so that
    /// the motion is even.
    pub fn set_display_hz(&self, hz: f64) {
        self.shared.mailbox.post(|requests| requests.display_hz = Some(hz));
    }

    /// Sets whether a take is played backwards. A simulation can only run forwards.
    pub fn set_backwards(&self, backwards: bool) {
        self.shared.mailbox.post(|requests| requests.backwards = Some(backwards));
    }

    /// Records every step from now on as a take, until [`Worker::finish_take`]. Failures are reported as events.
    pub fn record_take(&self, path: impl Into<PathBuf>) {
        let path = path.into();
        self.shared.mailbox.post(|requests| requests.take = Some(TakeRequest::Start(path)));
    }

    /// Completes the take that is being recorded.
    pub fn finish_take(&self) {
        self.shared.mailbox.post(|requests| requests.take = Some(TakeRequest::Finish));
    }

    /// Progress of the take that is being recorded, if any.
    pub fn take_progress(&self) -> Option<TakeProgress> {
        self.shared.recorded.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Progress of settling; `None` if the hair is settled.
    pub fn settling(&self) -> Option<PrerollProgress> {
        *self.shared.settling.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Cancels settling and continues with the current hair.
    pub fn cancel_settle(&self) {
        self.shared.mailbox.post(|requests| requests.settle = Some(false));
    }

    /// Seeks to a time, seconds. The hair moves rigidly at once and then settles in the background; playback waits for it.
    pub fn seek(&self, time_secs: f64) {
        self.shared.mailbox.post(|requests| {
            (requests.seek_secs, requests.look_back) = (Some(time_secs), false);
            (requests.steps, requests.restart) = (0, false);
        });
    }

    /// As [`Worker::seek`], but keeps the totals, to show where a value was measured.
    pub fn look_back(&self, time_secs: f64) {
        self.shared.mailbox.post(|requests| {
            (requests.seek_secs, requests.look_back) = (Some(time_secs), true);
            (requests.steps, requests.restart) = (0, false);
        });
    }

    /// Steps by a number of steps of 1/60 s. Forward steps are simulated; backward steps settle the hair as [`Worker::seek`] does.
    pub fn step(&self, steps: i64) {
        self.shared
            .mailbox
            .post(|requests| requests.steps = requests.steps.saturating_add(steps).clamp(-600, 600));
    }

    /// Moves to the first frame with settled hair.
    pub fn restart(&self) {
        self.shared.mailbox.post(|requests| {
            requests.restart = true;
            (requests.seek_secs, requests.steps) = (None, 0);
        });
    }

    /// Settles the hair at the current time.
    pub fn settle(&self) {
        self.shared.mailbox.post(|requests| requests.settle = Some(true));
    }

    /// Cancels the current load.
    pub fn cancel_load(&self) {
        self.shared.loader.cancel();
    }

    /// Uses a scene that does not come from the loader.
    #[cfg(test)]
    pub(crate) fn put_scene(&self, scene: Arc<Scene>) {
        let project = Arc::new(Project::default());
        self.shared
            .mailbox
            .post(|requests| requests.loaded = Some(load_thread::Loaded::Scene(scene, project)));
    }

    /// The memory of the hairstyles that are kept between layers, bytes; at most
    /// [`SceneLoader::MAX_LAYER_BYTES`](crate::scene::SceneLoader::MAX_LAYER_BYTES).
    pub fn layer_bytes(&self) -> u64 {
        self.shared.loader.layer_bytes()
    }

    /// The memory of the decoded frames of the take that plays, bytes; at most [`CACHE_BYTES`](lovelock_record::CACHE_BYTES).
    pub fn take_bytes(&self) -> u64 {
        self.shared.take_frames.bytes()
    }

    /// Progress of the current load, if any.
    pub fn load_progress(&self) -> Option<LoadProgress> {
        self.shared.loader.progress()
    }

    /// Whether a change of the project, or what was loaded for one, waits for the simulation: whether it loads or settles something is
    /// not known yet.
    pub fn has_changes(&self) -> bool {
        self.shared.mailbox.has_changes()
    }

    /// Whether a load is running or waiting.
    pub fn is_loading(&self) -> bool {
        self.shared.loader.is_busy()
    }

    /// The newest frame; `None` before the first scene is loaded.
    pub fn frame(&self) -> Option<Arc<FrameSnapshot>> {
        self.shared.frames.latest()
    }

    /// The newest frame as a shared value.
    pub fn frames(&self) -> &Latest<FrameSnapshot> {
        &self.shared.frames
    }

    /// Begins a stroke of a brush. It waits for the scene that has its layer. What it does is reported by [`Event::Brushed`].
    pub fn begin_stroke(&self, start: StrokeStart) {
        self.brush(BrushRequest::Begin(Box::new(start)));
    }

    /// Moves the brush of the stroke `id` to further samples, in the space of the head.
    pub fn stroke_to(&self, id: u64, samples: Vec<StrokeSample>) {
        self.brush(BrushRequest::To(id, samples));
    }

    /// Ends the stroke `id`.
    pub fn end_stroke(&self, id: u64) {
        self.brush(BrushRequest::End(id));
    }

    /// Forgets all strokes that have not ended.
    pub fn cancel_strokes(&self) {
        self.brush(BrushRequest::Cancel);
    }

    /// Lets brushes touch all hair again.
    pub fn thaw(&self) {
        self.brush(BrushRequest::Thaw);
    }

    fn brush(&self, request: BrushRequest) {
        self.shared.mailbox.post(|requests| requests.brushes.push(request));
    }

    /// Sets whether the hair stays in its rest shape instead of being simulated.
    pub fn set_still(&self, still: bool) {
        self.shared.mailbox.post(|requests| requests.still = Some(still));
    }

    /// The oldest unread event.
    pub fn poll_event(&self) -> Option<Event> {
        self.events.lock().unwrap_or_else(PoisonError::into_inner).try_recv().ok()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.shared.mailbox.post(|requests| requests.stop = true);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests;
