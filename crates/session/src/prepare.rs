//! Preparation of work without a window: a loaded scene, settled hair and a renderer.

use std::ops::{ControlFlow, Range};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use lovelock_project::Project;
use lovelock_project::error::{Problem, ProjectError};
use lovelock_project::files::Access;
use lovelock_render::{Backend, Gpu, GpuError, RenderError, Renderer};

use crate::clock::FrameClock;
use crate::engine::Engine;
use crate::progress::{Progress, report_progress};
use crate::scene::{LoadControl, Scene, SceneLoader};

/// Opens a renderer, on the device `gpu` if one is given.
///
/// # Errors
/// If there is no adapter for [`Backend::Gpu`], or it cannot be used.
pub fn open_renderer(choice: Backend, gpu: Option<&Arc<Gpu>>) -> Result<Renderer, ProjectError> {
    let renderer = match gpu {
        Some(gpu) => Renderer::on_device(gpu),
        None => Renderer::open(choice),
    };
    renderer.map_err(|error| match (&error, choice) {
        (RenderError::Gpu(GpuError::NoAdapter(_)), Backend::Gpu) => {
            ProjectError::work(format!("--backend gpu: {error}"))
        }
        _ => error.into(),
    })
}

/// Loads the scene. Also returns its problems and notes.
///
/// # Errors
/// If no hair can be grown, or [`ProjectError::Cancelled`].
pub fn load(
    project: &Project,
    access: &Access,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(Arc<Scene>, Vec<Problem>), ProjectError> {
    let cancelled = AtomicBool::new(false);
    let mut show = |what: &str, _: f32| {
        if progress(Progress::Loading { what: what.to_owned() }).is_break() {
            cancelled.store(true, std::sync::atomic::Ordering::Relaxed);
        }
    };
    let mut control = LoadControl { cancelled: &cancelled, progress: &mut show };
    let (scene, mut problems) = SceneLoader::new().load(project, access, &mut control)?;
    problems.extend(scene.notes.iter().cloned());
    Ok((scene, problems))
}

/// Rejects implausible frame ranges.
///
/// # Errors
/// An empty range, or one that lasts for weeks.
pub fn check_frames(frames: &Range<u64>) -> Result<(), ProjectError> {
    if frames.is_empty() {
        return Err(ProjectError::option(format!(
            "frames {}..{}: an empty range; the second number is one past the last frame",
            frames.start, frames.end
        )));
    }
    // About two weeks at 30 frames per second, which is a typing error.
    if frames.end > 40_000_000 {
        return Err(ProjectError::option(format!("frame {}: must be at most 40000000", frames.end)));
    }
    Ok(())
}

/// Number of steps between two progress reports.
pub const STEPS_PER_REPORT: u64 = 60;

/// An engine with hair that is settled at the step `start`, as after a seek in the window. If `first` is earlier, the engine stands
/// there on the same pre-roll, because a shutter may open before its frame.
///
/// # Errors
/// [`ProjectError::Cancelled`].
pub fn settled_at(
    scene: &Arc<Scene>,
    project: &Project,
    clock: &FrameClock,
    [start, first]: [u64; 2],
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Engine, ProjectError> {
    let mut engine = Engine::at_rest(Arc::clone(scene), project.simulation, clock.step_secs);
    engine.follow(project);
    engine.seek(clock.time_of_step(start.min(first)));
    let mut preroll = engine.preroll_of(start as i64);
    loop {
        let (done, total) = preroll.steps();
        if done % STEPS_PER_REPORT == 0 {
            report_progress(progress, Progress::Simulating { done, total })?;
        }
        if preroll.advance() {
            break;
        }
    }
    engine.take_settled(preroll);
    engine.begin_here();
    Ok(engine)
}

/// Simulates the steps before the first rendered one.
///
/// # Errors
/// [`ProjectError::Cancelled`].
pub fn simulate_to(
    engine: &mut Engine,
    step: u64,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), ProjectError> {
    let first = engine.at_step().max(0).unsigned_abs();
    let mut at = first;
    while at < step {
        report_progress(progress, Progress::Simulating { done: at - first, total: step - first })?;
        at = (at + STEPS_PER_REPORT).min(step);
        engine.advance_to_step(at);
    }
    Ok(())
}
