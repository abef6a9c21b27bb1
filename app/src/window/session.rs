//! The threads behind the window: simulation and rendering, with their latest results.

use lovelock_base::words::counted;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_panes::live::Live;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProjectError};
use lovelock_project::files::Access;
use lovelock_session::render_thread::{
    ImageQuality, Inputs, RenderRequest, RenderThread, RenderedImage, ShownMask,
};
use lovelock_session::resolution::Resolution;
use lovelock_session::scene::Scene;
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_session::stats::ImageTimes;
use lovelock_session::strokes::StrokeReport;
use lovelock_session::window_device::WindowDevice;
use lovelock_session::worker::{Event, Worker};

use super::readings::{LoadedBody, LoadedHair, LoadedSurroundings};
use super::work::{SHOW_WORK, Work};

/// Number of frames in the plot of stage times.
const PLOTTED_FRAMES: usize = 240;

/// Time without any change after which an image is rendered at its full size, and then with further samples.
const AT_REST: Duration = Duration::from_millis(250);

/// How images of the window are drawn.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ViewOptions {
    /// The rate that images keep while something moves, images per second, if their size is automatic.
    pub(crate) rate: Option<f32>,
    /// Whether the passes of images are shown and must be measured.
    pub(crate) measured: bool,
}

/// How a load has ended.
pub(crate) enum LoadEnd {
    /// With the scene of a project, and what could not be loaded.
    Loaded(Arc<Project>, Vec<Problem>),
    /// Without a scene: it was cancelled, or it failed as a whole.
    Nothing,
}

/// The engine's threads and their latest results.
pub(crate) struct Session {
    worker: Worker,
    painter: RenderThread,
    live: Live,
    access: Access,
    /// The project that was last sent to the simulation.
    simulated: Arc<Project>,
    /// Inputs of the user so far that an image shows.
    pub(crate) inputs: Inputs,
    /// The last request to the render thread.
    pub(crate) drawn: Option<RenderRequest>,
    resolution: Resolution,
    /// Since when the project and the frame have been those of the last request.
    same_since: Stopwatch,
    seen_painted: u64,
    seen_notices: u64,
    pub(crate) scene: Option<Arc<Scene>>,
    pub(crate) frame: Option<Arc<FrameSnapshot>>,
    pub(crate) painted: Option<Arc<RenderedImage>>,
    pub(crate) problems: Vec<Problem>,
    pub(crate) hair: LoadedHair,
    pub(crate) body: LoadedBody,
    pub(crate) surroundings: LoadedSurroundings,
    /// Notes about the curves that play.
    pub(crate) take_notes: Vec<String>,
    pub(crate) times: ImageTimes,
    pub(crate) playing: bool,
    /// Seconds of the dance per second.
    pub(crate) rate: f64,
    /// The refresh rate of the display that was last reported, images per second.
    display_hz: f64,
    /// Whether a take plays backwards.
    pub(crate) backwards: bool,
    /// Whether the progress of a load or of settling is shown.
    work_is_seen: bool,
    /// Since when something has been asked for that may have to be loaded or settled; `None` once all is done.
    working: Option<Stopwatch>,
    pub(crate) view: ViewOptions,
    pub(crate) draw_error: Option<String>,
    /// Messages that have not been shown yet.
    pub(crate) done: Vec<String>,
    /// Errors that have not been shown yet.
    pub(crate) failed: Vec<String>,
    /// The latest recorded take.
    pub(crate) saved_take: Option<PathBuf>,
    /// What brushes have done since the last pass.
    pub(crate) brushed: Vec<StrokeReport>,
    /// How loads have ended since the last pass.
    pub(crate) load_ends: Vec<LoadEnd>,
}

impl Session {
    /// Starts the threads for `project`, which draw on `device` where possible. Each requests a repaint of `ctx` when it has a new result.
    pub(crate) fn start(
        project: &Arc<Project>,
        access: Access,
        ctx: &egui::Context,
        device: &WindowDevice,
    ) -> Result<Self, ProjectError> {
        let wake = ctx.clone();
        let painter =
            RenderThread::start(device.clone(), move || super::images::wake(&wake)).map_err(|error| {
                ProjectError::work(format!("the render thread could not be started: {error}"))
            })?;
        let wake = ctx.clone();
        let live = Live::start(device.clone(), move || super::images::wake(&wake)).map_err(|error| {
            ProjectError::work(format!("the comparison thread could not be started: {error}"))
        })?;
        // While an image is rendered, its end repaints the window anyway. A repaint per step of the simulation would slow down
        // rendering.
        let (wake, busy) = (ctx.clone(), [painter.busy(), live.busy()]);
        let wake = move || {
            if !busy.iter().any(|busy| busy.load(std::sync::atomic::Ordering::Relaxed)) {
                super::images::wake(&wake);
            }
        };
        let worker = Worker::start(Arc::clone(project), access.clone(), device, Arc::new(wake))?;
        Ok(Self {
            worker,
            painter,
            live,
            access,
            simulated: Arc::clone(project),
            inputs: Inputs::default(),
            drawn: None,
            resolution: Resolution::default(),
            same_since: Stopwatch::start(),
            seen_painted: 0,
            seen_notices: 0,
            scene: None,
            frame: None,
            painted: None,
            problems: Vec::new(),
            hair: LoadedHair::default(),
            body: LoadedBody::default(),
            surroundings: LoadedSurroundings::default(),
            take_notes: Vec::new(),
            times: ImageTimes::new(PLOTTED_FRAMES),
            playing: true,
            rate: 1.0,
            display_hz: 0.0,
            backwards: false,
            work_is_seen: false,
            working: None,
            view: ViewOptions::default(),
            draw_error: None,
            done: Vec::new(),
            failed: Vec::new(),
            saved_take: None,
            brushed: Vec::new(),
            load_ends: Vec::new(),
        })
    }

    /// The simulation.
    pub(crate) fn worker(&self) -> &Worker {
        &self.worker
    }

    /// The render thread.
    pub(crate) fn painter(&self) -> &RenderThread {
        &self.painter
    }

    /// The thread that renders panes.
    pub(crate) fn live(&self) -> &Live {
        &self.live
    }

    /// The files that the project may read.
    pub(crate) fn access(&self) -> &Access {
        &self.access
    }

    /// Grants access to a file that the user picked.
    pub(crate) fn pick(&mut self, path: &Path) {
        self.access.pick(path);
    }

    /// Grants access to what was picked on an earlier day.
    pub(crate) fn allow(&mut self, grant: impl FnOnce(&mut Access)) {
        grant(&mut self.access);
    }

    /// Sets the path of the open project file, if any.
    pub(crate) fn set_project_path(&mut self, path: Option<&Path>) {
        self.access.set_project(path);
    }

    /// Starts or pauses playback.
    pub(crate) fn set_playing(&mut self, playing: bool) {
        self.playing = playing;
        self.worker.set_playing(playing);
    }

    /// Sets the rate of playback, seconds of the dance per second.
    pub(crate) fn set_rate(&mut self, rate: f64) {
        self.rate = rate;
        self.worker.set_rate(rate);
    }

    /// Sets the refresh rate of the display, images per second.
    pub(crate) fn set_display_hz(&mut self, hz: f64) {
        if hz.to_bits() != self.display_hz.to_bits() {
            self.display_hz = hz;
            self.worker.set_display_hz(hz);
        }
    }

    /// Sets whether a take plays backwards.
    pub(crate) fn set_backwards(&mut self, backwards: bool) {
        self.backwards = backwards;
        self.worker.set_backwards(backwards);
    }

    /// The length of the dance or of the take that plays, in frames at `fps` frames per second; at least one.
    pub(crate) fn frames(&self, fps: f64) -> u64 {
        match (&self.frame, &self.simulated.take.file) {
            // The last frame is shown for its whole duration.
            (Some(frame), Some(_)) => {
                ((frame.duration_secs + lovelock_session::clock::STEP_SECS) * fps).floor().max(1.0) as u64
            }
            _ => self.scene.as_ref().map_or(1, |scene| scene.frames(fps)),
        }
    }

    /// Collects the results of the threads. Returns messages for the user.
    pub(crate) fn update(&mut self) -> Vec<String> {
        let mut said = Vec::new();
        while let Some(event) = self.worker.poll_event() {
            match &event {
                Event::Loaded { problems, project, .. } => {
                    self.load_ends.push(LoadEnd::Loaded(Arc::clone(project), problems.clone()));
                }
                // The thread that panicked may be the loader.
                Event::LoadCancelled | Event::LoadFailed { .. } | Event::Panicked { .. } => {
                    self.load_ends.push(LoadEnd::Nothing);
                }
                _ => {}
            }
            match event {
                Event::Loaded { scene, problems, .. } => self.take_scene(scene, problems),
                Event::LoadCancelled => {
                    said.push("Loading was cancelled. The scene is unchanged.".to_owned());
                }
                Event::LoadFailed { message } | Event::TakeFailed { message } => self.failed.push(message),
                Event::EndReached => self.playing = false,
                Event::TakeSaved { report, because } => {
                    let why = because.map_or_else(String::new, |why| format!(", ended because {why}"));
                    self.done.push(format!(
                        "Saved the take {}: {:.1} s, {}{why}.",
                        report.path.display(),
                        report.duration_secs,
                        counted(report.frames, "frame", "frames")
                    ));
                    self.saved_take = Some(report.path);
                }
                Event::TakeUnreadable { message } => {
                    self.playing = false;
                    self.failed.push(message);
                }
                Event::Brushed(brushed) => self.brushed.push(brushed),
                Event::Panicked { thread, message } => {
                    self.failed.push(format!(
                        "The {thread} thread failed and was restarted. Save your project. ({message})"
                    ));
                }
            }
        }
        if let Some(frame) = self.worker.frame() {
            self.frame = Some(frame);
        }
        let newer = self.painter.images().newer_than(&mut self.seen_painted);
        // An image that was still being drawn when the page was left is not seen.
        if let Some(painted) = newer.filter(|_| self.drawn.is_some()) {
            // Times of another size, as those of the images before a change, say nothing about this one.
            if let (Some((size, ms)), Some(drawn)) = (painted.cost, &self.drawn)
                && drawn.quality != ImageQuality::Refined
                && drawn.size == size
            {
                self.resolution.take(ms, self.view.rate.unwrap_or_default());
            }
            self.times.push(painted.times, &painted.stats);
            self.painted = Some(painted);
        }
        self.draw_error = self.painter.error();
        said.extend(self.painter.notices().newer_than(&mut self.seen_notices).map(|said| (*said).clone()));
        said
    }

    /// Closes the renderer of the single image, which is not shown. The last image stays.
    pub(crate) fn leave_image(&mut self) {
        if self.drawn.take().is_some() {
            self.painter.rest();
        }
    }

    /// Closes the renderer of the single image and forgets the image, because it shows a project that is closed.
    pub(crate) fn forget_images(&mut self) {
        self.painter.rest();
        self.draw_again();
    }

    /// Asks for the current frame again, because what draws it has changed. The last image stays until then.
    pub(crate) fn ask_again(&mut self) {
        self.drawn = None;
    }

    /// Draws the current frame again, because its image was on a device that is lost.
    pub(crate) fn draw_again(&mut self) {
        (self.drawn, self.painted) = (None, None);
    }

    /// Sends changes on: the project to the simulation, and the frame to the render thread, with the project `seen` at the current
    /// time. Images have the size `size`, or less while something moves: see [`ViewOptions`]; they show `mask`, if any. Returns after which
    /// time it must be called again even if nothing happens: soon after a change, so that what it begins is seen.
    pub(crate) fn send(
        &mut self,
        project: &Arc<Project>,
        seen: &Arc<Project>,
        size: [u32; 2],
        mask: Option<&Arc<ShownMask>>,
    ) -> Option<Duration> {
        let changed = !Arc::ptr_eq(project, &self.simulated);
        if changed {
            self.inputs.changed(&self.simulated, project);
            self.simulated = Arc::clone(project);
            self.worker.set_project(Arc::clone(project), self.access.clone());
            self.working.get_or_insert_with(Stopwatch::start);
        }
        if self.backwards && project.take.file.is_none() {
            self.set_backwards(false);
        }
        let again = self.draw(seen, size, mask);
        again.into_iter().chain(changed.then_some(SHOW_WORK)).min()
    }

    /// Sends the frame to the render thread: see [`Session::send`].
    fn draw(
        &mut self,
        seen: &Arc<Project>,
        size: [u32; 2],
        mask: Option<&Arc<ShownMask>>,
    ) -> Option<Duration> {
        let frame = self.frame.as_ref()?;
        if size[0] == 0 || size[1] == 0 {
            return None;
        }
        // Frames are compared by identity and not by their step: seeking, settling and other hair make new frames of the same step.
        let same = self
            .drawn
            .as_ref()
            .is_some_and(|drawn| Arc::ptr_eq(&drawn.project, seen) && Arc::ptr_eq(&drawn.snapshot, frame));
        if !same {
            self.same_since = Stopwatch::start();
        }
        self.inputs.drawn(&frame.scene.source);
        let still = !self.playing && self.same_since.elapsed() >= AT_REST;
        let automatic = self.view.rate.is_some();
        let scale = if still || !automatic { 1.0 } else { self.resolution.scale() };
        let side = |side: u32| ((side as f32 * scale).round() as u32).clamp(16, side.max(16));
        let request = RenderRequest {
            project: Arc::clone(seen),
            snapshot: Arc::clone(frame),
            size: size.map(side),
            quality: match (automatic, still) {
                (false, _) => ImageQuality::Full,
                (true, false) => ImageQuality::Draft,
                (true, true) => ImageQuality::Refined,
            },
            measured: self.view.measured,
            mask: mask.cloned(),
            input: self.inputs.number(),
        };
        // At rest an image is only replaced by a better one; its scale follows the next movement.
        let fresh = same
            && self.drawn.as_ref().is_some_and(|drawn| {
                let same_mask = match (&drawn.mask, &request.mask) {
                    (Some(drawn), Some(request)) => Arc::ptr_eq(drawn, request),
                    (drawn, request) => drawn.is_none() && request.is_none(),
                };
                same_mask
                    && (drawn.quality, drawn.size, drawn.measured)
                        == (request.quality, request.size, request.measured)
            });
        if !fresh {
            self.painter.request(request.clone());
            self.drawn = Some(request);
        }
        (automatic && !still && !self.playing).then(|| AT_REST.saturating_sub(self.same_since.elapsed()))
    }

    /// Whether the progress of loading and of settling is shown now, and after which time the window must be painted again for it.
    /// Progress that is shown stays until all is done.
    pub(crate) fn follow_work(&mut self, dragged: bool) -> ([bool; 2], Option<Duration>) {
        let secs = Duration::from_secs_f64;
        let work = Work {
            loading: self.worker.load_progress().map(|load| secs(load.taken_secs)),
            settling: self.worker.settling().map(|settling| secs(settling.taken_secs)),
            unknown: self.worker.has_changes(),
            // The simulation waits for a take.
            at_once: self.simulated.take.file.is_some(),
            dragged,
            asked: self.working.as_ref().map_or(Duration::ZERO, Stopwatch::elapsed),
        };
        if work.is_done() {
            self.working = None;
        } else {
            self.working.get_or_insert_with(Stopwatch::start);
        }
        let (shown, again) = work.shown(self.work_is_seen);
        self.work_is_seen = shown.contains(&true) || (self.work_is_seen && !work.is_done());
        (shown, again)
    }

    /// Loads again although the project has not changed, because a file was picked that it could not read before.
    pub(crate) fn reload(&mut self, project: &Arc<Project>) {
        self.simulated = Arc::clone(project);
        self.worker.set_project(Arc::clone(project), self.access.clone());
    }

    fn take_scene(&mut self, scene: Arc<Scene>, problems: Vec<Problem>) {
        let notes = |places: &[Place]| {
            let noted = scene.notes.iter().filter(|note| places.contains(&note.place));
            noted.map(|note| note.message.clone()).collect()
        };
        let style = &scene.style;
        let (low, high) = style.guides.x.iter().zip(&style.guides.y).zip(&style.guides.z).fold(
            ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]),
            |(mut low, mut high), ((&x, &y), &z)| {
                for (axis, v) in [x, y, z].into_iter().enumerate() {
                    low[axis] = low[axis].min(v);
                    high[axis] = high[axis].max(v);
                }
                (low, high)
            },
        );
        self.hair = LoadedHair {
            counts: [style.wisps.len(), style.strands.count(), style.strands.segments()],
            size_m: std::array::from_fn(|axis| (high[axis] - low[axis]).max(0.0)),
            notes: notes(&[Place::Hair]),
        };
        let joints = lovelock_motion::joint_paths(&scene.body.skeleton);
        self.body = LoadedBody {
            clips: scene.clips.iter().map(|clip| clip.name.clone()).collect(),
            clip: scene.clip.as_ref().map_or_else(String::new, |clip| clip.name.clone()),
            head: joints.get(scene.body.head_joint).cloned().unwrap_or_default(),
            joints,
            face: lovelock_motion::face_names(&scene.body).into_iter().map(str::to_owned).collect(),
            notes: notes(&[Place::Body, Place::Motion]),
        };
        self.surroundings = LoadedSurroundings {
            picture: scene.surroundings.light.clone(),
            notes: notes(&[Place::Surroundings]),
        };
        self.take_notes = notes(&[Place::Take]);
        self.problems = problems;
        self.scene = Some(scene);
    }
}
