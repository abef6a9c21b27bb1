//! The simulation on its own thread, in real time.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use lovelock_wisp::SimulationSettings;

use super::load_thread::LoadThread;
use super::mailbox::{Mailbox, Wishes};
use super::{Engine, FrameSnapshot, LoadProgress, Scene};
use crate::{
    Access, BodySection, HairSection, MotionSection, Playback, Problem, Project, Slot, Stopwatch, StudioError,
};

/// Events that may wait for the interface; more are dropped, and logged.
const MOST_EVENTS: usize = 256;

/// Panics in a row after which the simulation rests until something changes.
const MOST_PANICS: u32 = 3;

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

/// What a scene is made from: other sections of a project need no load.
#[derive(Clone, Debug, PartialEq)]
struct SceneInputs {
    body: BodySection,
    motion: MotionSection,
    hair: HairSection,
    access: Access,
}

impl SceneInputs {
    fn of(project: &Project, access: &Access) -> Self {
        let Project { body, motion, hair, .. } = project.clone();
        Self { body, motion, hair, access: access.clone() }
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
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts both threads on a project, playing. The first frame appears when the scene is loaded.
    ///
    /// # Errors
    /// Where the system gives no threads.
    pub fn start(project: Arc<Project>, access: Access, wake: Wake) -> Result<Self, StudioError> {
        let (sender, events) = sync_channel(MOST_EVENTS);
        let outbox = Outbox { events: sender, wake };
        let mailbox = Mailbox::default();
        let frames = Slot::default();
        let to_simulation = mailbox.clone();
        let loader = Arc::new(LoadThread::start(outbox.clone(), move |scene| {
            to_simulation.ask(|wishes| wishes.scene = Some(scene));
        })?);
        mailbox.ask(|wishes| wishes.project = Some((project, access)));
        let inside = Inside {
            mailbox: mailbox.clone(),
            frames: frames.clone(),
            loader: Arc::clone(&loader),
            outbox,
            engine: None,
            settings: SimulationSettings::default(),
            inputs: None,
            playback: Playback::default(),
            panics: 0,
        };
        let thread = std::thread::Builder::new()
            .name("lovelock simulation".to_owned())
            .spawn(move || inside.run())
            .map_err(|error| StudioError::work(format!("the simulation thread could not start: {error}")))?;
        Ok(Self { mailbox, frames, events: Mutex::new(events), loader, thread: Some(thread) })
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

    /// Goes to a time, seconds; the hair moves along.
    pub fn seek(&self, time_secs: f64) {
        self.mailbox.ask(|wishes| {
            wishes.seek_secs = Some(time_secs);
            (wishes.steps, wishes.restart) = (0, false);
        });
    }

    /// Goes on by a number of steps of 1/60 s, or back. On, the hair is simulated; back, it moves along.
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
        self.mailbox.ask(|wishes| wishes.settle = true);
    }

    /// Gives up what is being loaded.
    pub fn cancel_load(&self) {
        self.loader.cancel();
    }

    /// Dances a scene that no loader has made.
    #[cfg(test)]
    pub(super) fn put_scene(&self, scene: Arc<Scene>) {
        self.mailbox.ask(|wishes| wishes.scene = Some(scene));
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

/// The simulation thread's own state.
struct Inside {
    mailbox: Mailbox,
    frames: Slot<FrameSnapshot>,
    loader: Arc<LoadThread>,
    outbox: Outbox,
    engine: Option<Engine>,
    settings: SimulationSettings,
    inputs: Option<SceneInputs>,
    playback: Playback,
    panics: u32,
}

impl Inside {
    fn run(mut self) {
        // Threads of its own: a step takes a millisecond, and would wait for the tiles of a picture in the common ones.
        let threads = rayon::ThreadPoolBuilder::new().thread_name(|i| format!("simulate {i}")).build().ok();
        let mut watch = Stopwatch::start();
        loop {
            let timeout = if self.engine.is_some() { self.playback.until_next_step() } else { None };
            let wishes = self.mailbox.take(timeout);
            if wishes.stop {
                return;
            }
            let elapsed_secs = watch.secs();
            watch = Stopwatch::start();
            let done = catch_unwind(AssertUnwindSafe(|| match &threads {
                Some(threads) => threads.install(|| self.turn(wishes, elapsed_secs)),
                None => self.turn(wishes, elapsed_secs),
            }));
            match done {
                Ok(()) => self.panics = 0,
                Err(panic) => self.recover(&*panic),
            }
        }
    }

    /// Does what is asked for and what time asks for, and shows the result.
    fn turn(&mut self, wishes: Wishes, elapsed_secs: f64) {
        let mut changed = self.obey(wishes);
        let due = self.playback.advance(elapsed_secs);
        let Some(engine) = &mut self.engine else { return };
        for _ in 0..due {
            if engine.is_at_end() {
                self.playback.set_playing(false);
                self.outbox.send(Event::EndReached);
                break;
            }
            engine.step();
            changed = true;
        }
        if changed {
            self.frames.put(engine.snapshot());
            self.outbox.wake();
        }
    }

    /// Does what is asked for; returns whether the frame may have changed.
    fn obey(&mut self, wishes: Wishes) -> bool {
        let Wishes { project, scene, playing, rate, seek_secs, steps, restart, settle, stop: _ } = wishes;
        let mut changed = false;
        if let Some((project, access)) = project {
            self.settings = project.simulation;
            if let Some(engine) = &mut self.engine {
                engine.set_settings(&self.settings);
            }
            let inputs = SceneInputs::of(&project, &access);
            if self.inputs.as_ref() != Some(&inputs) {
                self.inputs = Some(inputs);
                self.loader.request(project, access);
            }
        }
        if let Some(scene) = scene {
            match &mut self.engine {
                Some(engine) => engine.set_scene(scene),
                None => self.engine = Some(Engine::new(scene, self.settings)),
            }
            changed = true;
        }
        if let Some(rate) = rate {
            self.playback.set_rate(rate);
        }
        let Some(engine) = &mut self.engine else {
            if let Some(playing) = playing {
                self.playback.set_playing(playing);
            }
            return changed;
        };
        if let Some(playing) = playing {
            if playing && engine.is_at_end() {
                engine.restart();
            }
            self.playback.set_playing(playing);
        }
        if restart {
            engine.restart();
            changed = true;
        }
        if let Some(time_secs) = seek_secs {
            engine.seek(time_secs);
            changed = true;
        }
        if steps > 0 {
            (0..steps).for_each(|_| engine.step());
        } else if steps < 0 {
            engine.step_back(steps.unsigned_abs());
        }
        if settle {
            engine.settle();
        }
        changed || settle || steps != 0
    }

    /// After a panic the engine may be half way through a step: it starts again, in the same scene.
    fn recover(&mut self, panic: &(dyn Any + Send)) {
        self.outbox.panicked("simulation", panic);
        self.panics += 1;
        let scene = self.engine.take().map(|engine| Arc::clone(engine.scene()));
        if let (Some(scene), true) = (scene, self.panics < MOST_PANICS) {
            self.engine = catch_unwind(AssertUnwindSafe(|| Engine::new(scene, self.settings))).ok();
        }
        if self.engine.is_none() {
            // The same project may be asked for again.
            self.inputs = None;
        }
    }
}
