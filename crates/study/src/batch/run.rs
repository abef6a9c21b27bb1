//! Runs a comparison.

use std::ops::{ControlFlow, Range};
use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_render::{Backend, MapValue, Renderer};
use lovelock_session::dance::Dance;
use lovelock_session::machine::machine;
use lovelock_session::prepare::open_renderer;
use lovelock_session::progress::{Progress, report_progress};
use lovelock_session::scene::Scene;
use lovelock_session::snapshot::FrameSnapshot;

use super::entrants::entrants;
use super::folder::Folder;
use super::hair::lights;
use super::request::CompareRequest;
use super::work::Work;
use crate::report::{CompareReport, SceneFacts};

/// Compares methods at one instant of a project, and over the following frames if there are several. The report in `request.out`
/// grows during the run; each file is written under a temporary name and renamed.
///
/// `progress` is called for each part of the work and may cancel it. Finished parts are then kept, and the returned report is
/// marked as incomplete.
///
/// # Errors
/// [`ProjectError::exit_code`] 2 for an invalid request, 1 if the work fails (no adapter, a full disk). A method or reference that
/// needs too much memory is not an error: the report says so, with numbers.
pub fn compare(
    project: &Project,
    request: &CompareRequest,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<CompareReport, ProjectError> {
    let mut project = project.sanitised().0.compared();
    // Errors are those of the hair.
    project.picture.map_view.value = MapValue::None;
    let fps = request.fps.unwrap_or(project.recording.fps);
    let size = request.size.unwrap_or((project.recording.width, project.recording.height));
    check(&project, request, fps, size)?;
    let (mut renderers, mut notes) = open(&project, request)?;
    let backends: Vec<Backend> = renderers.iter().map(Renderer::backend).collect();
    let asked = (&request.methods[..], &request.draws_as[..], &request.transparencies[..]);
    let entrants = entrants(&project, asked, &backends, &request.sweeps)?;
    let folder = Folder::new(&request.out)?;

    let (mut dance, mut problems) = Dance::open(&project, &request.access, fps, progress)?;
    let frames = frames(&project, request, &dance, fps)?;
    dance.play_once(&frames, &mut problems);
    report_progress(progress, Progress::Loaded { problems: problems.clone() })?;
    notes.extend(problems.iter().map(ToString::to_string));
    let mut report = CompareReport {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        machine: machine(),
        frames: [frames.start, frames.end],
        scene: facts(&project, request, dance.scene(), fps, size),
        notes,
        ..CompareReport::default()
    };
    // Replace an earlier report before new images are written.
    folder.report(&report)?;
    let snapshots = instants(&mut dance, &frames, progress)?;
    let animated = project.is_animated();
    // Render all frames with the same settings, so that differences come from the method and not from a track.
    let project = snapshots
        .first()
        .map_or_else(|| project.clone(), |first| project.seen_at(first.position_secs).into_owned());
    if request.draws < CompareRequest::DEFAULT_DRAWS {
        report.notes.push(few_draws(request.draws.max(1)));
    }
    if request.quick {
        report.notes.push(QUICK.to_owned());
    }
    if animated && snapshots.len() > 1 {
        report.notes.push("Tracks stand still at their values of the first frame.".to_owned());
    }
    let work = Work {
        project: &project,
        request,
        folder: &folder,
        size: [size.0, size.1],
        lights: lights(&project),
    };
    match work.run(&snapshots, entrants, &mut renderers, &mut report, progress) {
        Ok(()) => report.complete = true,
        Err(ProjectError::Cancelled) => {
            report.notes.push(
                "Stopped before its end: the results here are complete, but others are missing.".to_owned(),
            );
        }
        Err(error) => return Err(error),
    }
    for method in &report.methods {
        let sentence = lovelock_shadow::fallbacks_sentence(method.fallbacks);
        report.notes.extend(sentence.map(|sentence| format!("{}: {sentence}", method.name)));
    }
    folder.report(&report)?;
    folder.tidy(&report);
    Ok(report)
}

/// The note on what a quick comparison leaves out.
const QUICK: &str =
    "This is a quick comparison: swim, banding, the turning light and the stray hair were not measured.";

/// The note on times of fewer draws than [`CompareRequest::DEFAULT_DRAWS`].
fn few_draws(draws: u32) -> String {
    let draws = if draws == 1 { "1 draw".to_owned() } else { format!("{draws} draws") };
    format!(
        "Each time was measured over only {draws}. Medians and the 10th to 90th percentiles of so few draws are rough; use {} or \
         more to compare times.",
        CompareRequest::DEFAULT_DRAWS
    )
}

/// Rejects what is wrong before anything is loaded.
fn check(
    project: &Project,
    request: &CompareRequest,
    fps: f64,
    (width, height): (u32, u32),
) -> Result<(), ProjectError> {
    lovelock_render::check_size(width, height)?;
    lovelock_record::FrameRate::from_fps(fps).map_err(ProjectError::option)?;
    if let Some(frames) = &request.frames
        && frames.is_empty()
    {
        return Err(ProjectError::option(format!(
            "frames {}..{}: an empty range; the second number is one past the last frame",
            frames.start, frames.end
        )));
    }
    if let Some([x, y]) = request.probes.iter().find(|[x, y]| *x >= width || *y >= height) {
        return Err(ProjectError::option(format!(
            "--probe {x},{y}: outside the image of {width}x{height} pixels"
        )));
    }
    if lights(project).is_empty() {
        return Err(ProjectError::option(
            "no light of the project is switched on: there is no shadow to compare",
        ));
    }
    Ok(())
}

/// Opens a renderer per backend. An unavailable backend is skipped with a note, unless it is the only one.
fn open(project: &Project, request: &CompareRequest) -> Result<(Vec<Renderer>, Vec<String>), ProjectError> {
    let own = [project.picture.backend];
    let asked = if request.backends.is_empty() { &own[..] } else { &request.backends };
    let mut renderers: Vec<Renderer> = Vec::new();
    let (mut notes, mut failed) = (Vec::new(), None);
    for &backend in asked {
        // A given device is only used for the GPU.
        let gpu = request.gpu.as_ref().filter(|_| backend == Backend::Gpu);
        match open_renderer(backend, gpu) {
            Ok(renderer) if renderers.iter().all(|open| open.backend() != renderer.backend()) => {
                renderers.push(renderer);
            }
            Ok(_) => {}
            Err(error) => {
                notes.push(format!("{backend} is left out: {error}"));
                failed = Some(error);
            }
        }
    }
    match failed {
        Some(error) if renderers.is_empty() => Err(error),
        _ => Ok((renderers, notes)),
    }
}

/// The requested frames, or the project's first one.
fn frames(
    project: &Project,
    request: &CompareRequest,
    dance: &Dance,
    fps: f64,
) -> Result<Range<u64>, ProjectError> {
    let in_clip = dance.frames();
    let first = project.recording.first_frame.min(in_clip - 1);
    let frames = request.frames.clone().unwrap_or(first..first + 1);
    if frames.end > in_clip {
        return Err(ProjectError::option(format!(
            "frame {} is outside the clip, which has frames 0 to {} at {fps} a second",
            frames.end - 1,
            in_clip - 1
        )));
    }
    Ok(frames)
}

fn facts(
    project: &Project,
    request: &CompareRequest,
    scene: &Scene,
    fps: f64,
    (width, height): (u32, u32),
) -> SceneFacts {
    let strands = &scene.style.strands;
    SceneFacts {
        name: request.name.clone(),
        fps,
        width,
        height,
        strands: strands.count() as u64,
        points: strands.points() as u64,
        segments: strands.segments() as u64,
        extinction_scale: project.look.extinction_scale,
        lights: lights(project).len() as u32,
        draws: request.draws.max(1),
    }
}

/// Simulates up to the last frame, and returns the snapshots of the requested ones.
fn instants(
    dance: &mut Dance,
    frames: &Range<u64>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<Arc<FrameSnapshot>>, ProjectError> {
    dance.begin(frames.start, dance.secs_of(frames.start), progress)?;
    let mut snapshots = Vec::new();
    for frame in frames.clone() {
        snapshots.push(dance.snapshot(frame)?);
        report_progress(
            progress,
            Progress::Frame {
                done: frame + 1 - frames.start,
                total: frames.end - frames.start,
                steps_per_frame: dance.steps_per_frame(),
            },
        )?;
    }
    Ok(snapshots)
}
