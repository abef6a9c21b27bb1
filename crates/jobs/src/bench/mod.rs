//! Measures whole frames of known scenes, stage by stage, and compares them with published figures.

mod baseline;
mod bound;
mod comparison;
mod crowd;
mod csv;
mod locks;
mod memory;
mod occupancy_order;
mod published;
mod report;
mod scaling;
mod scenes;
mod simulation;
mod text;
mod voxel_map;
mod yardstick;

pub use baseline::Baseline;
pub use comparison::{Comparison, SlowerStage};
pub use locks::{LockFigures, LockReport, LockScene, Spread};
pub use occupancy_order::{OrderReport, OrderTimes};
pub use report::{BenchReport, ScalingReport, SceneReport, StageReport, ThreadRun};
pub(crate) use scaling::counted;
pub use scenes::BenchScene;
pub use voxel_map::{VoxelMapReport, VoxelMapRow};
pub use yardstick::{Bound, Yardstick};

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use lovelock_base::clock::Stopwatch;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::Access;
use lovelock_render::{
    Backend, HairDrawing, HairPose, Picture, RenderError, Renderer, ShadowMethod, Transparency,
};
use lovelock_session::clock::FrameClock;
use lovelock_session::engine::Engine;
use lovelock_session::health::health;
use lovelock_session::machine::machine;
use lovelock_session::scene::{LoadControl, Scene, SceneLoader};

use bound::Amounts;
use crowd::Crowd;

/// What to measure. Scenes without rendering ([`BenchScene::is_simulated_alone`]) only use `simulate` and `frames`.
#[derive(Clone, Debug)]
pub struct BenchRequest {
    /// The scenes, in order.
    pub scenes: Vec<BenchScene>,
    /// The hairstyles whose locks are measured in motion, in order. The rest of the request does not apply to them.
    pub locks: Vec<LockScene>,
    /// Whether the voxel map is timed against the published loop. The rest of the request does not apply to it.
    pub voxel_map: bool,
    /// Whether occupancy order is timed against exact order. It has its own scenes and modes.
    pub occupancy_order: bool,
    /// The backends, in order; an unavailable one is skipped with a note.
    pub backends: Vec<Backend>,
    /// What simulates the hair of scenes without rendering; `None` uses the scene's own, the CPU. The CPU simulates rendered scenes.
    pub simulate: Option<Backend>,
    /// Number of frames to measure, after one that is not counted.
    pub frames: u32,
    /// Width and height, pixels; `None` uses the scene's own.
    pub size: Option<(u32, u32)>,
    /// The shadow method; `None` uses the scene's own.
    pub shadow: Option<ShadowMethod>,
    /// What hair is drawn as; `None` uses the scene's own.
    pub draw: Option<HairDrawing>,
    /// The transparency; `None` uses the scene's own.
    pub transparency: Option<Transparency>,
    /// Numbers of threads with which the scenes are measured, in order; all threads of the machine if empty. They apply to the CPU
    /// backend.
    pub threads: Vec<usize>,
}

impl Default for BenchRequest {
    fn default() -> Self {
        Self {
            scenes: BenchScene::ALL.into_iter().filter(|scene| !scene.is_huge()).collect(),
            locks: Vec::new(),
            voxel_map: false,
            occupancy_order: false,
            backends: vec![Backend::Cpu, Backend::Gpu],
            simulate: None,
            frames: 15,
            size: None,
            shadow: None,
            draw: None,
            transparency: None,
            threads: Vec::new(),
        }
    }
}

/// The frame at which measuring starts, when the hair is in full motion.
const FIRST_FRAME: u64 = 40;

/// Measures the yardstick, then all that is requested. `change` is applied to the project of every scene first. `progress` is called with each scene and backend before
/// it starts, and may cancel.
///
/// # Errors
/// If the size is out of range or hair cannot be grown, those of `change`, or [`ProjectError::Cancelled`].
pub fn bench(
    request: &BenchRequest,
    change: &dyn Fn(&mut Project) -> Result<(), ProjectError>,
    progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
) -> Result<BenchReport, ProjectError> {
    if let Some((width, height)) = request.size {
        lovelock_render::check_size(width, height)?;
    }
    let mut notes = Vec::new();
    let mut renderers = Vec::new();
    let drawn = request.occupancy_order || request.scenes.iter().any(|scene| !scene.is_simulated_alone());
    for &backend in request.backends.iter().filter(|_| drawn) {
        match Renderer::open(backend) {
            Ok(renderer) => renderers.push(renderer),
            // An unavailable backend is only noted.
            Err(error @ RenderError::Gpu(_)) => {
                notes.push(format!("{backend}: {error}"));
            }
            Err(error) => return Err(error.into()),
        }
    }
    if progress("the yardstick").is_break() {
        return Err(ProjectError::Cancelled);
    }
    let yardstick = Yardstick::measure();
    let mut scenes = Vec::new();
    for &scene in request.scenes.iter().filter(|_| request.threads.is_empty()) {
        let prepared = Prepared::new(scene, request, change)?;
        scenes.extend(prepared.measure(request, &mut renderers, &yardstick, &mut notes, progress)?);
    }
    let scaling = if request.threads.is_empty() {
        Vec::new()
    } else {
        scaling::measure(request, change, &mut renderers, &mut notes, progress)?
    };
    let mut locks = Vec::new();
    for scene in &request.locks {
        if progress(&scene.id()).is_break() {
            return Err(ProjectError::Cancelled);
        }
        let mut project = scene.project();
        change(&mut project)?;
        locks.push(locks::measure(*scene, &project, &load(&project)?));
    }
    let voxel_map = if request.voxel_map { Some(voxel_map::measure(progress)?) } else { None };
    let mut orders = Vec::new();
    for scene in occupancy_order::SCENES.into_iter().filter(|_| request.occupancy_order) {
        let project = changed(scene, request, change)?;
        let loaded = load(&project)?;
        for renderer in &mut renderers {
            let what = format!("occupancy-order, {} on {}", scene.id(), renderer.adapter());
            if progress(&what).is_break() {
                return Err(ProjectError::Cancelled);
            }
            orders.push(occupancy_order::measure(scene, &project, &loaded, renderer, request)?);
        }
    }
    notes.extend(yardstick.change_note(&Yardstick::measure()));
    Ok(BenchReport {
        machine: machine(),
        yardstick,
        scenes,
        scaling,
        locks,
        voxel_map,
        occupancy_order: orders,
        comparison: None,
        notes,
    })
}

/// A scene with its project, loaded.
struct Prepared {
    scene: BenchScene,
    project: Project,
    loaded: Arc<Scene>,
}

impl Prepared {
    fn new(
        scene: BenchScene,
        request: &BenchRequest,
        change: &dyn Fn(&mut Project) -> Result<(), ProjectError>,
    ) -> Result<Self, ProjectError> {
        let mut project = changed(scene, request, change)?;
        project.picture.draw = request.draw.unwrap_or(project.picture.draw);
        project.picture.transparency = request.transparency.unwrap_or(project.picture.transparency);
        let loaded = load(&project)?;
        Ok(Self { scene, project, loaded })
    }

    /// Measures the scene with each renderer, or its simulation alone.
    fn measure(
        &self,
        request: &BenchRequest,
        renderers: &mut [Renderer],
        yardstick: &Yardstick,
        notes: &mut Vec<String>,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<Vec<SceneReport>, ProjectError> {
        let Self { scene, project, loaded } = self;
        if scene.is_simulated_alone() {
            if progress(scene.id()).is_break() {
                return Err(ProjectError::Cancelled);
            }
            let (report, note) = self.measure_simulation(request, yardstick);
            notes.push(note);
            return Ok(vec![report]);
        }
        let mut reports = Vec::new();
        for renderer in renderers {
            if progress(&format!("{} on {}", scene.id(), renderer.adapter())).is_break() {
                return Err(ProjectError::Cancelled);
            }
            let mut report = measure(*scene, project, loaded, renderer, request)?;
            let amounts = amounts(project, loaded, &report);
            for stage in &mut report.stages {
                // The yardstick is that of the CPU.
                if renderer.is_software() || ON_CPU.contains(&stage.name.as_str()) {
                    stage.measure_by(yardstick, &amounts);
                }
            }
            reports.push(report);
        }
        Ok(reports)
    }

    /// The simulation alone, and a sentence about it.
    fn measure_simulation(&self, request: &BenchRequest, yardstick: &Yardstick) -> (SceneReport, String) {
        let (mut report, note) = simulation::measure(self.scene, &self.project, &self.loaded, request);
        let amounts = Amounts {
            simulated_points: report.points,
            strand_points: self.loaded.style.strands.points() as u64,
            ..Amounts::default()
        };
        let mut stages = std::mem::take(&mut report.stages);
        // The yardstick is that of the CPU.
        for stage in stages.iter_mut().filter(|stage| report.is_on_cpu(&stage.name)) {
            stage.measure_by(yardstick, &amounts);
        }
        (SceneReport { stages, ..report }, note)
    }
}

/// Stages of rendered scenes that run on the CPU whatever draws.
const ON_CPU: [&str; 2] = ["motion", "simulate"];

/// The project of a scene with the changes of the command line.
fn changed(
    scene: BenchScene,
    request: &BenchRequest,
    change: &dyn Fn(&mut Project) -> Result<(), ProjectError>,
) -> Result<Project, ProjectError> {
    let mut project = scene.project();
    change(&mut project)?;
    project.picture.simulate = request.simulate.unwrap_or(project.picture.simulate);
    project.shadow.method = request.shadow.unwrap_or(project.shadow.method);
    Ok(project)
}

/// The amount of work in a frame of a rendered scene.
fn amounts(project: &Project, loaded: &Scene, report: &SceneReport) -> Amounts {
    let clock = FrameClock::new(30.0);
    let steps = clock.step_of_frame(FIRST_FRAME + 1) - clock.step_of_frame(FIRST_FRAME);
    Amounts {
        strand_points: report.points,
        lights: project.lights.iter().filter(|light| light.enabled).count() as u64,
        simulated_points: loaded.style.guides.x.len() as u64 * steps,
        vertices: loaded.body.mesh.positions.len() as u64,
        pixels: u64::from(report.width) * u64::from(report.height),
    }
}

/// The scene of a project whose files can all be read.
///
/// # Errors
/// The first problem.
pub(crate) fn load(project: &Project) -> Result<Arc<Scene>, ProjectError> {
    let cancelled = AtomicBool::new(false);
    let mut silent = |_: &str, _: f32| {};
    let mut control = LoadControl { cancelled: &cancelled, progress: &mut silent };
    let (scene, problems) = SceneLoader::new().load(project, &Access::default(), &mut control)?;
    match problems.first() {
        Some(problem) => Err(ProjectError::work(problem)),
        None => Ok(scene),
    }
}

fn measure(
    scene: BenchScene,
    project: &Project,
    loaded: &Arc<Scene>,
    renderer: &mut Renderer,
    request: &BenchRequest,
) -> Result<SceneReport, ProjectError> {
    let (width, height) = request.size.unwrap_or(scene.size());
    memory::reset_peak_memory();
    let clock = FrameClock::new(30.0);
    let mut engine = Engine::with_step(Arc::clone(loaded), project.simulation, clock.step_secs);
    engine.advance_to_step(clock.step_of_frame(FIRST_FRAME));
    let mut picture = Picture::default();
    let mut crowd = scene.is_of_crowd().then(|| Crowd::new(&loaded.style));
    let style = crowd.as_ref().map_or(&loaded.style, |crowd| &crowd.style).clone();
    let mut frames = Vec::new();
    for frame in 0..=u64::from(request.frames.max(1)) {
        let watch = Stopwatch::start();
        engine.advance_to_step(clock.step_of_frame(FIRST_FRAME + 1 + frame));
        let snapshot = engine.snapshot();
        let camera = snapshot.camera(&project.camera);
        let mut input = snapshot.measured_input(project, &camera);
        if let Some(crowd) = &mut crowd {
            let guides = crowd.follow(&snapshot.guides);
            (input.style, input.hair, input.guides) = (&style, HairPose::Guides(guides), Some(guides));
        }
        let stats = renderer.picture(&input, width, height, &mut picture)?;
        let mut times = snapshot.times;
        times.take_picture(&stats);
        // The first frame creates buffers.
        if frame > 0 {
            frames.push((watch.ms(), times, stats));
        }
    }
    let gauges = health(&engine.totals(), engine.rest_inside(), loaded, &project.simulation);
    Ok(SceneReport::new(scene, project, renderer, [width, height], &style.strands, gauges, &frames))
}
