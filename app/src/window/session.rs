//! What runs behind the window: the simulation, the drawing, and what they said last.

use std::path::PathBuf;
use std::sync::Arc;

use lovelock_panes::live::Live;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProjectError};
use lovelock_project::files::Access;
use lovelock_session::render_thread::{RenderRequest, RenderThread, RenderedImage};
use lovelock_session::scene::Scene;
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_session::stats::{PassHistory, StageHistory};
use lovelock_session::worker::{Event, Worker};

use super::panels::{body, hair};

/// Frames that the plot of stage times shows.
const PLOTTED_FRAMES: usize = 240;

/// The engine's threads, and what they left last.
pub(crate) struct Session {
    worker: Worker,
    painter: RenderThread,
    live: Live,
    access: Access,
    /// What was last handed to the simulation.
    simulated: Arc<Project>,
    /// What was last handed to the drawing: the project, the frame and the size.
    pub(crate) drawn: Option<(Arc<Project>, Arc<FrameSnapshot>, [u32; 2])>,
    seen_painted: u64,
    seen_notices: u64,
    pub(crate) scene: Option<Arc<Scene>>,
    pub(crate) frame: Option<Arc<FrameSnapshot>>,
    pub(crate) painted: Option<Arc<RenderedImage>>,
    pub(crate) problems: Vec<Problem>,
    pub(crate) hair: hair::Loaded,
    pub(crate) body: body::Loaded,
    pub(crate) stages: StageHistory,
    pub(crate) passes: PassHistory,
    pub(crate) playing: bool,
    /// Seconds of the dance a second.
    pub(crate) rate: f64,
    /// Pictures a second that the display shows, as was last told.
    display_hz: f64,
    /// Whether a take plays from its end to its start.
    pub(crate) backwards: bool,
    /// Whether the progress of a load is on the screen.
    pub(crate) load_is_seen: bool,
    pub(crate) draw_error: Option<String>,
    /// Sentences about what is done, not told yet.
    pub(crate) done: Vec<String>,
    /// The take that was recorded last.
    pub(crate) saved_take: Option<PathBuf>,
}

impl Session {
    /// Starts the threads on `project`; each asks `ctx` to repaint when it has something new.
    pub(crate) fn start(
        project: &Arc<Project>,
        access: Access,
        ctx: &egui::Context,
    ) -> Result<Self, ProjectError> {
        let wake = ctx.clone();
        let painter = RenderThread::start(move || wake.request_repaint())
            .map_err(|error| ProjectError::work(format!("no thread to draw on: {error}")))?;
        let wake = ctx.clone();
        let live = Live::start(move || wake.request_repaint())
            .map_err(|error| ProjectError::work(format!("no thread to compare on: {error}")))?;
        // While a picture is drawn, its end will repaint the window: a repaint for every step of the simulation
        // would take the processor from the drawing.
        let (wake, busy) = (ctx.clone(), [painter.busy(), live.busy()]);
        let wake = move || {
            if !busy.iter().any(|busy| busy.load(std::sync::atomic::Ordering::Relaxed)) {
                wake.request_repaint();
            }
        };
        let worker = Worker::start(Arc::clone(project), access.clone(), Arc::new(wake))?;
        Ok(Self {
            worker,
            painter,
            live,
            access,
            simulated: Arc::clone(project),
            drawn: None,
            seen_painted: 0,
            seen_notices: 0,
            scene: None,
            frame: None,
            painted: None,
            problems: Vec::new(),
            hair: hair::Loaded::default(),
            body: body::Loaded::default(),
            stages: StageHistory::new(PLOTTED_FRAMES),
            passes: PassHistory::new(PLOTTED_FRAMES),
            playing: true,
            rate: 1.0,
            display_hz: 0.0,
            backwards: false,
            load_is_seen: false,
            draw_error: None,
            done: Vec::new(),
            saved_take: None,
        })
    }

    /// The simulation.
    pub(crate) fn worker(&self) -> &Worker {
        &self.worker
    }

    /// What draws.
    pub(crate) fn painter(&self) -> &RenderThread {
        &self.painter
    }

    /// What draws panes beside each other.
    pub(crate) fn live(&self) -> &Live {
        &self.live
    }

    /// Which files the project may reach.
    pub(crate) fn access(&self) -> &Access {
        &self.access
    }

    /// The user named this file.
    pub(crate) fn pick(&mut self, path: &std::path::Path) {
        self.access.pick(path);
    }

    /// Another project file is open, or none.
    pub(crate) fn set_project_path(&mut self, path: Option<&PathBuf>) {
        self.access.set_project(path.map(PathBuf::as_path));
    }

    /// Plays or pauses.
    pub(crate) fn set_playing(&mut self, playing: bool) {
        self.playing = playing;
        self.worker.set_playing(playing);
    }

    /// Seconds of the dance a second.
    pub(crate) fn set_rate(&mut self, rate: f64) {
        self.rate = rate;
        self.worker.set_rate(rate);
    }

    /// How many pictures the display shows in a second.
    pub(crate) fn set_display_hz(&mut self, hz: f64) {
        if hz.to_bits() != self.display_hz.to_bits() {
            self.display_hz = hz;
            self.worker.set_display_hz(hz);
        }
    }

    /// Whether a take plays from its end to its start.
    pub(crate) fn set_backwards(&mut self, backwards: bool) {
        self.backwards = backwards;
        self.worker.set_backwards(backwards);
    }

    /// Frames that the dance, or the take that plays, lasts at `fps` frames a second; at least one.
    pub(crate) fn frames(&self, fps: f64) -> u64 {
        match (&self.frame, &self.simulated.take.file) {
            // Its last frame is shown for its length.
            (Some(frame), Some(_)) => {
                ((frame.duration_secs + lovelock_session::clock::STEP_SECS) * fps).floor().max(1.0) as u64
            }
            _ => self.scene.as_ref().map_or(1, |scene| scene.frames(fps)),
        }
    }

    /// Takes what the threads left. Returns sentences that the user should see.
    pub(crate) fn update(&mut self) -> Vec<String> {
        let mut said = Vec::new();
        while let Some(event) = self.worker.poll_event() {
            match event {
                Event::Loaded { scene, problems } => self.take_scene(scene, problems),
                Event::LoadCancelled => {
                    said.push("Loading was cancelled; the scene stays as it was.".to_owned());
                }
                Event::LoadFailed { message } | Event::TakeFailed { message } => said.push(message),
                Event::EndReached => self.playing = false,
                Event::TakeSaved { report, because } => {
                    let why = because.map_or_else(String::new, |why| format!(", ended because {why}"));
                    self.done.push(format!(
                        "The take is in {}: {:.1} s, {} frames{why}.",
                        report.path.display(),
                        report.duration_secs,
                        report.frames
                    ));
                    self.saved_take = Some(report.path);
                }
                Event::TakeUnreadable { message } => {
                    self.playing = false;
                    said.push(message);
                }
                Event::Panicked { thread, message } => {
                    said.push(format!(
                        "The {thread} met an error and started again; save your project. ({message})"
                    ));
                }
            }
        }
        if let Some(frame) = self.worker.frame() {
            self.frame = Some(frame);
        }
        if let Some(painted) = self.painter.images().newer_than(&mut self.seen_painted) {
            self.stages.push(painted.times);
            self.passes.push(&painted.stats.passes);
            self.painted = Some(painted);
        }
        self.draw_error = self.painter.error();
        said.extend(self.painter.notices().newer_than(&mut self.seen_notices).map(|said| (*said).clone()));
        said
    }

    /// Hands on what has changed: the project to the simulation, the frame to the drawing, with the project as it is `seen`
    /// where the dance is.
    pub(crate) fn send(&mut self, project: &Arc<Project>, seen: &Arc<Project>, size: [u32; 2]) {
        if !Arc::ptr_eq(project, &self.simulated) {
            self.simulated = Arc::clone(project);
            self.worker.set_project(Arc::clone(project), self.access.clone());
        }
        if self.backwards && project.take.file.is_none() {
            self.set_backwards(false);
        }
        let Some(frame) = &self.frame else { return };
        // Frames are told apart by what they are and not by their step, which only passing time raises: going to
        // another time, settling and other hair make new frames of the same step.
        let fresh = self.drawn.as_ref().is_some_and(|(drawn, drawn_frame, drawn_size)| {
            Arc::ptr_eq(drawn, seen) && Arc::ptr_eq(drawn_frame, frame) && *drawn_size == size
        });
        if !fresh && size[0] > 0 && size[1] > 0 {
            self.painter.request(RenderRequest {
                project: Arc::clone(seen),
                snapshot: Arc::clone(frame),
                width: size[0],
                height: size[1],
            });
            self.drawn = Some((Arc::clone(seen), Arc::clone(frame), size));
        }
    }

    /// Loads again although the project has not changed: a file was picked that it could not reach before.
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
        self.hair = hair::Loaded {
            counts: [style.wisps.len(), style.strands.count(), style.strands.segments()],
            size_m: std::array::from_fn(|axis| (high[axis] - low[axis]).max(0.0)),
            notes: notes(&[Place::Hair]),
        };
        let joints = lovelock_motion::joint_paths(&scene.body.skeleton);
        self.body = body::Loaded {
            clips: scene.clips.iter().map(|clip| clip.name.clone()).collect(),
            head: joints.get(scene.body.head_joint).cloned().unwrap_or_default(),
            joints,
            notes: notes(&[Place::Body, Place::Motion]),
        };
        self.problems = problems;
        self.scene = Some(scene);
    }
}
