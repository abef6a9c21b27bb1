//! The state of the simulation thread: an engine or a take, and the handling of requests.

mod brushing;
mod inputs;
mod playing;
mod recording;
mod settling;
#[cfg(test)]
mod tests;

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;

use brushing::Brushing;
use inputs::SceneInputs;
use lovelock_base::clock::Stopwatch;
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_simulation::SimulationSettings;
use settling::{PendingPreroll, preroll_differs};

use super::load_thread::Loaded;
use super::mailbox::{Requests, TakeRequest};
use super::{Outbox, Shared};
use crate::clock::{Playback, STEP_SECS};
use crate::engine::{Engine, LastSteps};
use crate::scene::Scene;
use crate::take::{TakeRecording, TakeTransport};
use crate::threads::own_workers;
use crate::window_device::WindowDevice;

/// Number of consecutive panics after which the simulation stops until something changes.
const MAX_PANICS: u32 = 3;

/// Time after which what waits for a scene or a take is looked at again.
const AGAIN: Duration = Duration::from_millis(50);

/// The state of the simulation thread.
pub(super) struct SimulationThread {
    shared: Shared,
    outbox: Outbox,
    window: WindowDevice,
    engine: Option<Engine>,
    /// The pre-roll that leads to the engine's instant. Playback waits for it.
    preroll: Option<PendingPreroll>,
    /// Whether loaded hair still has to settle, which waits while newer hair is being loaded.
    settling_pending: bool,
    /// Time since the last change of settings while playback is paused. The hair settles again when changes stop.
    settings_changed: Option<Stopwatch>,
    /// The take that is played instead of the engine.
    take: Option<TakeTransport>,
    recording: Option<TakeRecording>,
    project: Option<Arc<Project>>,
    /// The project that the engine's scene was loaded from, which may be older than `project`.
    scene_of: Option<Arc<Project>>,
    settings: SimulationSettings,
    inputs: Option<SceneInputs>,
    playback: Playback,
    /// The last two steps, for images between them.
    last_steps: LastSteps,
    backwards: bool,
    brushing: Brushing,
    /// Whether the hair stays in its rest shape.
    still: bool,
    panics: u32,
}

impl SimulationThread {
    pub(super) fn new(shared: Shared, outbox: Outbox, window: WindowDevice) -> Self {
        Self {
            shared,
            outbox,
            window,
            engine: None,
            preroll: None,
            settling_pending: false,
            settings_changed: None,
            take: None,
            recording: None,
            project: None,
            scene_of: None,
            settings: SimulationSettings::default(),
            inputs: None,
            playback: Playback::default(),
            last_steps: LastSteps::default(),
            backwards: false,
            brushing: Brushing::default(),
            still: false,
            panics: 0,
        }
    }

    pub(super) fn run(mut self) {
        // A step takes a millisecond, less than the tiles of an image.
        let threads = own_workers("simulate");
        let mut watch = Stopwatch::start();
        loop {
            let timeout = match (&self.take, &self.engine) {
                (None, _) if self.awaits_take() => Some(AGAIN),
                _ if self.preroll.is_some() => Some(Duration::ZERO),
                // A take is interpolated at any rate: one snapshot per image.
                (Some(_), _) => {
                    self.playback.is_playing().then(|| Duration::from_secs_f64(self.playback.picture_secs()))
                }
                (None, Some(_)) => self.playback.until_next(),
                (None, None) => None,
            };
            let timeout =
                if self.has_waiting_strokes() { Some(timeout.unwrap_or(AGAIN).min(AGAIN)) } else { timeout };
            let requests = self.shared.mailbox.take(self.until_calm(timeout));
            if requests.stop {
                // Closing the window must not lose the recording.
                let _ = catch_unwind(AssertUnwindSafe(|| self.finish_begun_step()));
                self.end_take(None);
                return;
            }
            let elapsed_secs = watch.secs();
            watch = Stopwatch::start();
            let done = catch_unwind(AssertUnwindSafe(|| match &threads {
                Some(threads) => threads.install(|| self.turn(requests, elapsed_secs)),
                None => self.turn(requests, elapsed_secs),
            }));
            match done {
                Ok(()) => self.panics = 0,
                Err(panic) => self.recover(&*panic),
            }
        }
    }

    /// Handles requests and elapsed time, and publishes the result.
    fn turn(&mut self, requests: Requests, elapsed_secs: f64) {
        let finished = self.finish_begun_step();
        let changed = self.handle(requests);
        self.settle_when_calm();
        // Publish the progress before the frame, so that readers of the frame know that its hair is not settled.
        self.publish_settling();
        if self.take.is_some() {
            (self.preroll, self.settling_pending) = (None, false);
            self.play(changed, elapsed_secs);
        } else if self.awaits_take() {
            // Hair that moves on would not be that of the take.
            if changed {
                self.show();
            }
        } else if self.preroll.is_some() {
            self.advance_preroll(changed);
        } else {
            self.simulate(changed, finished, elapsed_secs);
        }
        self.shared.take_frames.set(self.take.as_ref().map_or(0, TakeTransport::cached_bytes));
        self.publish_settling();
    }

    /// Handles requests. Returns whether the frame may have changed.
    fn handle(&mut self, requests: Requests) -> bool {
        let Requests {
            project,
            loaded,
            playing,
            rate,
            display_hz,
            backwards,
            seek_secs,
            look_back,
            steps,
            restart,
            settle,
            take,
            brushes,
            still,
            stop: _,
        } = requests;
        if let Some((project, access)) = project {
            self.set_project(project, access);
        }
        let mut changed = loaded.is_some();
        if let Some(loaded) = loaded {
            self.set_loaded(loaded);
            self.shared.loader.arrived();
        }
        if let Some(rate) = rate {
            self.playback.set_rate(rate);
        }
        if let Some(hz) = display_hz {
            self.playback.set_display_hz(hz);
        }
        if let Some(backwards) = backwards {
            self.backwards = backwards;
        }
        if let Some(playing) = playing {
            if playing {
                self.leave_the_end();
            }
            self.playback.set_playing(playing);
            // A paused frame shows a whole step.
            changed |= !playing && self.take.is_none() && self.last_steps.are_known();
        }
        changed |= match (&mut self.take, &mut self.engine) {
            (Some(take), _) => {
                if restart {
                    take.restart(false);
                }
                if let Some(secs) = seek_secs {
                    take.seek(secs);
                }
                take.step(steps);
                restart || seek_secs.is_some() || steps != 0
            }
            (None, Some(engine)) => {
                let measured = (look_back && seek_secs.is_some()).then(|| engine.totals());
                if restart {
                    engine.seek(0.0);
                }
                if let Some(secs) = seek_secs {
                    engine.seek(secs);
                }
                if steps < 0 {
                    engine.step_back(steps.unsigned_abs());
                }
                let gone_to = restart || seek_secs.is_some() || steps < 0;
                if gone_to || settle == Some(true) {
                    self.begin_preroll();
                    if let Some(aside) = &mut self.preroll {
                        aside.measured = measured;
                    }
                } else if settle == Some(false) {
                    let owed = std::mem::take(&mut self.settling_pending);
                    if self.preroll.take().is_some() || owed {
                        self.playback.set_playing(self.playback.is_playing());
                    }
                }
                gone_to || steps != 0
            }
            (None, None) => false,
        };
        if self.take.is_none() {
            for _ in 0..steps {
                match &mut self.preroll {
                    Some(aside) => aside.steps = aside.steps.saturating_add(1),
                    None => self.step(),
                }
            }
        }
        changed |= self.set_still(still);
        changed |= self.brush(brushes);
        match take {
            Some(TakeRequest::Start(path)) => self.start_take(&path),
            Some(TakeRequest::Finish) => self.end_take(None),
            None => {}
        }
        changed
    }

    fn set_project(&mut self, project: Arc<Project>, access: Access) {
        self.settings = project.simulation;
        if let Some(engine) = &mut self.engine {
            engine.follow(&project);
        }
        if self.project.as_ref().is_some_and(|before| preroll_differs(before, &project)) {
            self.restart_preroll();
            self.settings_changed = Some(Stopwatch::start());
        }
        if let Some(take) = &mut self.take {
            take.set_looping(project.motion.looping);
        }
        self.project = Some(Arc::clone(&project));
        self.brushing.follow(&project);
        if !self.brushing.is_open() {
            // A stroke changes the project many times a second.
            self.record_change();
        }
        let inputs = SceneInputs::of(&project, &access);
        if self.inputs.as_ref() != Some(&inputs) {
            self.inputs = Some(inputs);
            self.shared.loader.request(project, access);
        }
    }

    fn set_loaded(&mut self, loaded: Loaded) {
        match loaded {
            Loaded::Take(player) => {
                self.end_take(Some("another take was opened"));
                // A take that is opened again, for example with other surroundings, continues.
                let secs = self.take.as_ref().and_then(|take| take.position_in(player.path()));
                let mut take = TakeTransport::new(*player);
                if let Some(secs) = secs {
                    take.seek(secs);
                }
                if let Some(project) = &self.project {
                    take.set_looping(project.motion.looping);
                }
                self.take = Some(take);
            }
            Loaded::Scene(scene, project) => {
                self.take = None;
                self.backwards = false;
                match self.recording.as_mut().map(|recording| recording.set_scene(&scene)) {
                    None | Some(Ok(true)) => {}
                    Some(Ok(false)) => self.end_take(Some("there is no hair any more")),
                    Some(Err(error)) => self.fail_take(&error),
                }
                self.set_scene(scene);
                self.scene_of = Some(project);
                self.record_change();
            }
        }
    }

    /// Whether a take is being opened in place of the simulation.
    fn awaits_take(&self) -> bool {
        self.project.as_ref().is_some_and(|project| project.take.file.is_some())
            && self.shared.loader.is_busy()
    }

    fn set_scene(&mut self, scene: Arc<Scene>) {
        if let Some(engine) = &mut self.engine {
            let before = engine.scene();
            let other_hair = !Arc::ptr_eq(&before.style, &scene.style)
                || !Arc::ptr_eq(&before.colliders, &scene.colliders)
                || before.field.is_some() != scene.field.is_some()
                || before.field_lift_m.to_bits() != scene.field_lift_m.to_bits();
            let (brushed, brushes) = (self.brushing.awaits(), self.brushing.is_open());
            let frame = brushed.then(|| engine.frame_of_guides());
            let laid = engine.set_scene(scene);
            let stays = frame.filter(|_| !laid).is_some_and(|frame| self.brushing.keep(engine, &frame));
            if self.still && (laid || !brushes) {
                engine.lay_at_rest();
            }
            if self.still || stays {
                // Hair that was brushed stays as it is.
                (self.preroll, self.settling_pending) = (None, false);
                return;
            }
            // During playback, hair that only changes or gets other colliders keeps moving. While paused, it settles visibly.
            let waits = self.preroll.is_some() || self.settling_pending;
            if laid || waits || (other_hair && !self.playback.is_playing()) {
                self.settle_loaded();
            }
            return;
        }
        let mut engine = Engine::at_rest(scene, self.settings, STEP_SECS);
        engine.share(&self.window);
        if let Some(project) = &self.project {
            engine.follow(project);
        }
        self.engine = Some(engine);
        self.begin_preroll();
    }

    /// Moves from the end to the start before playback starts.
    fn leave_the_end(&mut self) {
        if let Some(take) = &mut self.take {
            if take.is_at_end(self.backwards) {
                take.restart(self.backwards);
            }
        } else if let Some(engine) = &mut self.engine
            && engine.is_at_end()
        {
            engine.seek(0.0);
            self.begin_preroll();
        }
    }

    /// After a panic the engine may be in the middle of a step, so it restarts with the same scene.
    fn recover(&mut self, panic: &(dyn Any + Send)) {
        self.outbox.panicked("simulation", panic);
        self.shared.loader.arrived();
        self.panics += 1;
        let played = self.take.take().is_some();
        (self.preroll, self.settling_pending) = (None, false);
        self.last_steps.forget();
        self.forget_strokes();
        let scene = self.engine.take().map(|engine| Arc::clone(engine.scene()));
        if let (Some(scene), true) = (scene, self.panics < MAX_PANICS) {
            self.engine = catch_unwind(AssertUnwindSafe(|| Engine::new(scene, self.settings))).ok();
            if let (Some(engine), Some(project)) = (&mut self.engine, &self.project) {
                engine.share(&self.window);
                engine.follow(project);
            }
        }
        if self.engine.is_none() || played {
            // Allow loading the same project again.
            self.inputs = None;
        }
    }
}
