//! Records only the simulation, as fast as possible.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

use lovelock_base::clock::Stopwatch;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_record::{FrameRate, TAKE_EXTENSION, TakeReport};
use lovelock_session::clock::FrameClock;
use lovelock_session::dance::replace_loop_note;
use lovelock_session::health::{Gauge, health};
use lovelock_session::prepare::{check_frames, load, settled_at};
use lovelock_session::progress::{Progress, report_progress};
use lovelock_session::take::TakeRecording;
use serde::Serialize;

use super::request::RecordRequest;

/// The result of recording a take, as `record --json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TakeRecordReport {
    /// The take.
    pub out: String,
    /// Number of frames.
    pub frames: u64,
    /// Frames per second of the take: one per simulation step.
    pub fps: f64,
    /// Its length, seconds.
    pub duration_secs: f64,
    /// Bytes written.
    pub bytes: u64,
    /// Number of guides.
    pub guides: u64,
    /// Points per guide.
    pub points_per_guide: u64,
    /// Total time without loading, milliseconds.
    pub ms: f64,
    /// Largest relative change of a link's length.
    pub max_stretch: f32,
    /// Deepest point inside the body, metres.
    pub max_penetration_m: f32,
    /// Number of guides that became non-finite and were reset.
    pub recovered_guides: u64,
    /// The gauges of the simulation, with advice for those over their limits.
    pub health: Vec<Gauge>,
    /// Hash of the last simulated state, 16 hexadecimal digits.
    pub state_hash: String,
    /// Notes, such as parts that could not be loaded, as sentences.
    pub notes: Vec<String>,
}

/// Whether an output name has the extension of takes.
pub fn is_take(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(TAKE_EXTENSION))
}

/// Records the simulation of a project as a take: every step from the first requested frame to the last one.
///
/// # Errors
/// As [`super::record`], or if the project plays a take itself. Frames written before a disk failure are kept.
pub fn record_take(
    project: &Project,
    request: &RecordRequest,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<TakeRecordReport, ProjectError> {
    let (mut project, _) = project.sanitised();
    if let Some(file) = &project.take.file {
        return Err(ProjectError::option(format!(
            "{}: the project already plays a take: {}",
            request.out.display(),
            file.path.display()
        )));
    }
    let of_films = request.seamless.then_some("--loop");
    if let Some(option) = request.option_of_pictures().or(of_films) {
        return Err(ProjectError::option(format!(
            "{option}: {} is a take, which holds only the simulation, not images",
            request.out.display()
        )));
    }
    let fps = request.fps.unwrap_or(project.recording.fps);
    FrameRate::from_fps(fps).map_err(ProjectError::option)?;
    if let Some(frames) = &request.frames {
        check_frames(frames)?;
    }
    let (mut scene, mut problems) = load(&project, &request.access, progress)?;
    let frames = request.frames.clone().unwrap_or_else(|| project.recording.frame_range(scene.frames(fps)));
    check_frames(&frames)?;
    if let Some(once) = scene.played_once(&frames, fps) {
        replace_loop_note(&scene, &mut problems);
        // The take plays the motion of the project that it stores.
        project.motion.looping = false;
        scene = Arc::new(once);
    }
    report_progress(progress, Progress::Loaded { problems: problems.clone() })?;
    let clock = FrameClock::new(fps);
    let first = clock.step_of_frame(frames.start);
    let mut engine = settled_at(&scene, &project, &clock, [first, first], progress)?;
    let watch = Stopwatch::start();
    let project = Arc::new(project);
    let mut take = TakeRecording::start(&request.out, &project, &engine)?;
    let last = clock.step_of_frame(frames.end) - 1;
    for step in clock.step_of_frame(frames.start) + 1..=last {
        engine.advance_to_step(step);
        take.push(&engine)?;
        if step % u64::from(clock.steps_per_frame) == 0 {
            let done = step / u64::from(clock.steps_per_frame) - frames.start;
            let told = report_progress(
                progress,
                Progress::Frame {
                    done,
                    total: frames.end - frames.start,
                    steps_per_frame: clock.steps_per_frame,
                },
            );
            if let Err(cancelled) = told {
                take.discard()?;
                return Err(cancelled);
            }
        }
    }
    report_progress(progress, Progress::Finishing)?;
    let TakeReport { frames, bytes, duration_secs, .. } = take.finish()?;
    let totals = engine.totals();
    let guides = &scene.style.guides;
    Ok(TakeRecordReport {
        out: request.out.display().to_string(),
        frames,
        fps: 1.0 / clock.step_secs,
        duration_secs,
        bytes,
        guides: guides.count() as u64,
        points_per_guide: guides.points_per_guide as u64,
        ms: watch.ms(),
        max_stretch: totals.max_stretch,
        max_penetration_m: totals.max_penetration_m,
        recovered_guides: totals.recovered_guides,
        health: health(&totals, engine.rest_inside(), &scene, &project.simulation),
        state_hash: format!("{:016x}", engine.state_hash()),
        notes: problems.iter().map(ToString::to_string).collect(),
    })
}
