//! The loop of a recording: the window's engine with a fixed clock.

use std::ops::ControlFlow;
use std::path::Path;

use lovelock_record::{FrameRate, OutputKind, PictureSink, RecordError, SinkSettings};
use lovelock_render::Picture;

use super::burn_in::burn_in;
use super::dance::Dance;
use super::drawer::Drawer;
use super::new_folders::NewFolders;
use super::prepare::{check_frames, tell};
use super::{Progress, RecordReport, RecordRequest};
use crate::{PassHistory, Project, StageHistory, Stopwatch, StudioError};

/// The most frames of which times are kept for the medians.
const MOST_TIMES: usize = 1 << 20;

/// Records a project: simulates from its first frame, draws the frames asked for, and writes them.
///
/// `progress` is told each stage and frame, and may stop the recording. The simulation's bytes depend on the
/// project and the frame rate alone.
///
/// # Errors
/// [`StudioError::exit_code`] 2 for a wrong request, 1 where the work fails (no adapter, a full disk). Nothing is
/// left under the final name of a film then; of a sequence the frames that are whole are. Folders that were made
/// for it and hold nothing go.
pub fn record(
    project: &Project,
    request: &RecordRequest,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<RecordReport, StudioError> {
    let job = Job::new(project, request)?;
    let (mut dance, mut problems) = Dance::open(&job.project, &request.access, job.fps, progress)?;
    tell(progress, Progress::Loaded { problems: problems.clone() })?;

    let frames = job.frames(&dance)?;
    // After what the request may get wrong: drivers speak on standard error while they are tried.
    let mut drawer = Drawer::open(&job.project, request)?;
    if job.project.recording.seamless {
        dance.close(&frames)?;
    }
    dance.begin(frames.start, progress)?;

    let refused = |error: RecordError| job.refused(&error);
    // Before the sink, to be dropped after it.
    let _new_folders = NewFolders::missing_on(&request.out);
    let mut sink = PictureSink::for_path(&request.out, job.sink_settings(&frames)).map_err(refused)?;
    let mut picture = Picture::default();
    let most_times = ((frames.end - frames.start) as usize).min(MOST_TIMES);
    let (mut history, mut passes) = (StageHistory::new(most_times), PassHistory::new(most_times));
    let (mut shadow_bytes, mut draw_bytes) = (0, 0);
    let mut whole = Vec::new();
    for frame in frames.clone() {
        let watch = Stopwatch::start();
        let snapshot = dance.snapshot(frame)?;
        let at = job.project.seen_at(&snapshot);
        let stats = drawer.picture(&at, &snapshot, [job.width, job.height], &mut picture)?;
        if request.label {
            burn_in(&mut picture, &job.label(frame));
        }
        let encoding = Stopwatch::start();
        sink.push(&picture.rgba).map_err(refused)?;
        let mut times = snapshot.times;
        times.take_picture(&stats);
        times.encode = encoding.ms();
        history.push(times);
        passes.push(&stats.passes);
        (shadow_bytes, draw_bytes) = (stats.shadow_bytes.max(shadow_bytes), stats.draw_bytes.max(draw_bytes));
        whole.push(watch.ms());
        let (done, total) = (frame + 1 - frames.start, frames.end - frames.start);
        tell(progress, Progress::Frame { done, total })?;
    }
    tell(progress, Progress::Finishing)?;
    let written = sink.finish().map_err(refused)?;

    problems.extend(dance.notices());
    let totals = dance.totals();
    let strands = &dance.scene().style.strands;
    Ok(RecordReport {
        out: request.out.clone(),
        frames: written.frames(),
        first_frame: frames.start,
        fps: job.fps,
        width: job.width,
        height: job.height,
        backend: drawer.backend(),
        adapter: drawer.adapter().to_owned(),
        shadow: job.project.shadow.method.to_string(),
        transparency: job.project.picture.transparency.to_string(),
        strands: strands.count() as u64,
        segments: strands.segments() as u64,
        frame_ms: crate::median(whole.into_iter()),
        stage_ms: history.medians(),
        passes_ms: passes.medians().into_iter().map(|pass| (pass.name, pass.ms)).collect(),
        shadow_bytes,
        draw_bytes,
        max_stretch: totals.max_stretch,
        max_penetration_m: totals.max_penetration_m,
        recovered_guides: totals.recovered_guides,
        state_hash: dance.state_hash().map_or_else(String::new, |hash| format!("{hash:016x}")),
        bytes: written.bytes(),
        steps_per_frame: dance.steps_per_frame(),
        notes: problems.iter().map(ToString::to_string).collect(),
    })
}

/// A request together with the project, checked.
struct Job<'a> {
    project: Project,
    request: &'a RecordRequest,
    fps: f64,
    width: u32,
    height: u32,
}

impl<'a> Job<'a> {
    /// Checks the request before anything is loaded.
    fn new(project: &Project, request: &'a RecordRequest) -> Result<Self, StudioError> {
        let (mut project, _) = project.sanitised();
        if let Some(shadow) = request.shadow {
            project.shadow.method = shadow;
        }
        if let Some(quality) = request.quality {
            project.recording.quality = quality;
        }
        project.recording.seamless |= request.seamless;
        if let Some(transparency) = request.transparency {
            project.picture.transparency = transparency;
        }
        let fps = request.fps.unwrap_or(project.recording.fps);
        let (width, height) = request.size.unwrap_or((project.recording.width, project.recording.height));
        let job = Self { project, request, fps, width, height };
        lovelock_render::check_size(width, height)?;
        FrameRate::from_fps(fps).map_err(|error| job.refused(&error))?;
        if let Some(frames) = &request.frames {
            check_frames(frames)?;
        }
        let kind = OutputKind::of(&request.out).map_err(|error| job.refused(&error))?;
        if kind == OutputKind::Preview {
            // Their number is known when the dance is.
            let frames = request.frames.as_ref().map_or(1, |frames| frames.end - frames.start);
            lovelock_record::PreviewSettings { width, height, fps, frames, alpha: false }
                .check()
                .map_err(|error| job.refused(&error))?;
        }
        if kind == OutputKind::Film {
            let quality = job.project.recording.quality;
            lovelock_record::FilmSettings { width, height, fps, quality }
                .check()
                .map_err(|error| job.refused(&error))?;
        }
        Ok(job)
    }

    /// The frames to draw: as asked for, else as the project says, else the whole clip.
    fn frames(&self, dance: &Dance) -> Result<std::ops::Range<u64>, StudioError> {
        let recording = &self.project.recording;
        let frames = self.request.frames.clone().unwrap_or_else(|| {
            let first = recording.first_frame;
            first..recording.end_frame.unwrap_or_else(|| dance.frames().max(first + 1))
        });
        check_frames(&frames)?;
        dance.check(&frames)?;
        Ok(frames)
    }

    fn sink_settings(&self, frames: &std::ops::Range<u64>) -> SinkSettings {
        let mut settings = SinkSettings::new(self.width, self.height, self.fps);
        (settings.first_frame, settings.frames) = (frames.start, frames.end - frames.start);
        settings.quality = self.project.recording.quality;
        settings.settings = serde_json::json!({
            "shadow": self.project.shadow.method.id(),
            "transparency": self.project.picture.transparency.id(),
        });
        settings
    }

    /// What is written into a frame.
    fn label(&self, frame: u64) -> String {
        let (shadow, transparency) =
            (self.project.shadow.method.label(), self.project.picture.transparency.label());
        format!("{shadow} · {transparency} · frame {frame} · {:.2} s", frame as f64 / self.fps)
    }

    fn refused(&self, error: &RecordError) -> StudioError {
        let file = error.path().map(Path::to_owned);
        if error.is_request() {
            let file = file.or_else(|| Some(self.request.out.clone()));
            StudioError::Request { file, message: error.to_string() }
        } else {
            StudioError::Work { file, message: error.to_string() }
        }
    }
}
