//! The comparison from beginning to end.

use std::ops::{ControlFlow, Range};
use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::error::StudioError;
use lovelock_render::{Backend, Renderer};
use lovelock_session::dance::Dance;
use lovelock_session::machine::machine;
use lovelock_session::prepare::open_renderer;
use lovelock_session::progress::{Progress, tell};
use lovelock_session::scene::Scene;
use lovelock_session::snapshot::FrameSnapshot;

use super::entrants::entrants;
use super::folder::Folder;
use super::hair::lights;
use super::request::CompareRequest;
use super::work::Work;
use crate::report::{CompareReport, SceneFacts};

/// Compares methods on one instant of a project's dance, and over the frames after it where there are several. The report
/// grows in `request.out` while it runs; each file is written beside its name and renamed.
///
/// `progress` is told each part of the work, and may stop it: what is finished stays, and the report that is returned says
/// that it is not complete.
///
/// # Errors
/// [`StudioError::exit_code`] 2 for a wrong request, 1 where the work fails (no adapter, a full disk). A method or a reference
/// that needs too much memory is no error: the report says so, with the numbers.
pub fn compare(
    project: &Project,
    request: &CompareRequest,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<CompareReport, StudioError> {
    let (project, _) = project.sanitised();
    let fps = request.fps.unwrap_or(project.recording.fps);
    let size = request.size.unwrap_or((project.recording.width, project.recording.height));
    check(&project, request, fps, size)?;
    let (mut renderers, mut notes) = open(&project, request)?;
    let backends: Vec<Backend> = renderers.iter().map(Renderer::backend).collect();
    let entrants = entrants(&project, &request.methods, &request.transparencies, &backends, &request.sweeps)?;
    let folder = Folder::new(&request.out)?;

    let (mut dance, problems) = Dance::open(&project, &request.access, fps, progress)?;
    tell(progress, Progress::Loaded { problems: problems.clone() })?;
    notes.extend(problems.iter().map(ToString::to_string));
    let frames = frames(&project, request, &dance, fps)?;
    let mut report = CompareReport {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        machine: machine(),
        frames: [frames.start, frames.end],
        scene: facts(&project, request, dance.scene(), fps, size),
        notes,
        ..CompareReport::default()
    };
    // A report of before does not stand beside pictures of now.
    folder.report(&report)?;
    let snapshots = instants(&mut dance, &frames, progress)?;
    let animated = project.is_animated();
    // Frames of one film are drawn alike: what differs between them is then the method's and not a track's.
    let project = snapshots
        .first()
        .map_or_else(|| project.clone(), |first| project.seen_at(first.position_secs).into_owned());
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
        Err(StudioError::Cancelled) => {
            report
                .notes
                .push("Stopped before its end: what is here is whole, and more was asked for.".to_owned());
        }
        Err(error) => return Err(error),
    }
    folder.report(&report)?;
    folder.tidy(&report);
    Ok(report)
}

/// What can be told to be wrong before anything is loaded.
fn check(
    project: &Project,
    request: &CompareRequest,
    fps: f64,
    (width, height): (u32, u32),
) -> Result<(), StudioError> {
    lovelock_render::check_size(width, height)?;
    lovelock_record::FrameRate::from_fps(fps).map_err(StudioError::option)?;
    if let Some(frames) = &request.frames
        && frames.is_empty()
    {
        return Err(StudioError::option(format!(
            "frames {}..{}: an empty range; the second number is one past the last frame",
            frames.start, frames.end
        )));
    }
    if let Some([x, y]) = request.probes.iter().find(|[x, y]| *x >= width || *y >= height) {
        return Err(StudioError::option(format!(
            "--probe {x},{y}: outside the picture of {width}x{height} pixels"
        )));
    }
    if lights(project).is_empty() {
        return Err(StudioError::option(
            "no light of the project is switched on: there is no shadow to compare",
        ));
    }
    Ok(())
}

/// Opens what draws, each backend once. One that this machine has not costs its own numbers alone, unless it is the only one.
fn open(project: &Project, request: &CompareRequest) -> Result<(Vec<Renderer>, Vec<String>), StudioError> {
    let own = [project.picture.backend];
    let asked = if request.backends.is_empty() { &own[..] } else { &request.backends };
    let mut renderers: Vec<Renderer> = Vec::new();
    let (mut notes, mut failed) = (Vec::new(), None);
    for &backend in asked {
        // A device that is given stands for the graphics card alone.
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

/// The frames to look at: as asked for, else the project's first one.
fn frames(
    project: &Project,
    request: &CompareRequest,
    dance: &Dance,
    fps: f64,
) -> Result<Range<u64>, StudioError> {
    let in_clip = dance.frames();
    let first = project.recording.first_frame.min(in_clip - 1);
    let frames = request.frames.clone().unwrap_or(first..first + 1);
    if frames.end > in_clip {
        return Err(StudioError::option(format!(
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
        extinction_scale: project.shadow.safe_extinction_scale(),
        lights: lights(project).len() as u32,
        draws: request.draws.max(1),
    }
}

/// Lives through the dance up to the last frame, and keeps those that are asked for.
fn instants(
    dance: &mut Dance,
    frames: &Range<u64>,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Vec<Arc<FrameSnapshot>>, StudioError> {
    dance.begin(frames.start, dance.secs_of(frames.start), progress)?;
    let mut snapshots = Vec::new();
    for frame in frames.clone() {
        snapshots.push(dance.snapshot(frame)?);
        tell(progress, Progress::Frame { done: frame + 1 - frames.start, total: frames.end - frames.start })?;
    }
    Ok(snapshots)
}
