//! What all work without a window begins with: a loaded scene, hair that has lived, and something that draws.

use std::ops::{ControlFlow, Range};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use lovelock_render::{Backend, Gpu, GpuError, RenderError, Renderer};

use super::Progress;
use crate::{Access, Engine, FrameClock, LoadControl, Problem, Project, Scene, SceneLoader, StudioError};

/// Opens what draws: `gpu` where one is given.
///
/// # Errors
/// No adapter for [`Backend::Gpu`], or one that cannot be used.
pub(crate) fn open_renderer(choice: Backend, gpu: Option<&Arc<Gpu>>) -> Result<Renderer, StudioError> {
    let renderer = match gpu {
        Some(gpu) => Renderer::on_device(Arc::clone(gpu)),
        None => Renderer::open(choice),
    };
    renderer.map_err(|error| match (&error, choice) {
        (RenderError::Gpu(GpuError::NoAdapter(_)), Backend::Gpu) => {
            StudioError::work(format!("--backend gpu: {error}"))
        }
        _ => error.into(),
    })
}

/// Loads the scene, and says what of it is missing.
///
/// # Errors
/// Hair that cannot be grown, or [`StudioError::Cancelled`].
pub(crate) fn load(
    project: &Project,
    access: &Access,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(Arc<Scene>, Vec<Problem>), StudioError> {
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

/// Refuses frames that nobody can mean.
///
/// # Errors
/// An empty range, and one that goes on for weeks.
pub(crate) fn check_frames(frames: &Range<u64>) -> Result<(), StudioError> {
    if frames.is_empty() {
        return Err(StudioError::option(format!(
            "frames {}..{}: an empty range; the second number is one past the last frame",
            frames.start, frames.end
        )));
    }
    // About two weeks at 30 frames a second: a slip of the finger.
    if frames.end > 40_000_000 {
        return Err(StudioError::option(format!("frame {} is farther than any dance goes", frames.end)));
    }
    Ok(())
}

/// Steps between two reports of progress.
pub(crate) const STEPS_A_REPORT: u64 = 60;

/// A simulation whose hair is settled at the step `start`, the same hair as in the window where one goes to that time; or on its
/// way there at `first`, where that is earlier: a shutter may open before its frame.
///
/// # Errors
/// [`StudioError::Cancelled`].
pub(crate) fn settled_at(
    scene: &Arc<Scene>,
    project: &Project,
    clock: &FrameClock,
    [start, first]: [u64; 2],
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Engine, StudioError> {
    let mut engine = Engine::at_rest(Arc::clone(scene), project.simulation, clock.step_secs);
    engine.follow(project);
    engine.seek(clock.time_of_step(start.min(first)));
    let mut preroll = engine.preroll_of(start as i64);
    loop {
        let (done, total) = preroll.steps();
        if done % STEPS_A_REPORT == 0 {
            tell(progress, Progress::Simulating { done, total })?;
        }
        if preroll.advance() {
            break;
        }
    }
    engine.take_settled(preroll);
    engine.begin_here();
    Ok(engine)
}

/// Lives through the steps before the first one that is drawn.
///
/// # Errors
/// [`StudioError::Cancelled`].
pub(crate) fn simulate_to(
    engine: &mut Engine,
    step: u64,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), StudioError> {
    let first = engine.at_step().max(0).unsigned_abs();
    let mut at = first;
    while at < step {
        tell(progress, Progress::Simulating { done: at - first, total: step - first })?;
        at = (at + STEPS_A_REPORT).min(step);
        engine.advance_to_step(at);
    }
    Ok(())
}

/// Tells how far the work is.
///
/// # Errors
/// [`StudioError::Cancelled`] where it is to stop.
pub(crate) fn tell(
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    what: Progress,
) -> Result<(), StudioError> {
    match progress(what) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(StudioError::Cancelled),
    }
}

impl From<RenderError> for StudioError {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Size { .. } => Self::option(error),
            error => Self::work(error),
        }
    }
}
