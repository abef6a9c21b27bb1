//! Records images: the main loop.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

use lovelock_base::clock::Stopwatch;
use lovelock_base::settings::Choices;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProblemKind, ProjectError};
use lovelock_record::{
    FrameLayers, FrameRate, OutputKind, PictureSink, RecordError, SequenceFormat, SinkSettings,
};
use lovelock_render::{FrameStats, HairDrawing, Layers, PendingPicture, Picture};
use lovelock_session::dance::Dance;
use lovelock_session::new_folders::NewFolders;
use lovelock_session::prepare::check_frames;
use lovelock_session::progress::{Progress, report_progress};
use lovelock_session::scene::camera_for_size;
use lovelock_session::snapshot::FrameSnapshot;
use lovelock_session::stats::{PassHistory, StageHistory, StageTimes};

use super::burn_in::{burn_in, burn_in_light};
use super::drawer::{Drawer, PANES_ALONE};
use super::fingerprint;
use super::options::Options;
use super::report::RecordReport;
use super::request::RecordRequest;
use super::sound::FilmSound;

/// Maximum number of frames whose times are kept for medians.
const MAX_TIMES: usize = 1 << 20;

/// Records a project: simulates the pre-roll, then renders and writes the requested frames.
///
/// `progress` is called for each stage and frame, and may cancel the recording. The simulation depends only on the project and the
/// frame rate.
///
/// # Errors
/// [`ProjectError::exit_code`] 2 for an invalid request, 1 if the work fails (no adapter, a full disk). Then no film is left under
/// its final name, but what plays of it can be kept; complete frames of a sequence are kept, and new empty folders are removed.
pub fn record(
    project: &Project,
    request: &RecordRequest,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<RecordReport, ProjectError> {
    let mut job = Job::new(project, request)?;
    let (mut dance, mut problems) = Dance::open(&job.project, &request.access, job.fps, progress)?;
    if request.dance_time {
        dance.count_on_dance();
    }
    let frames = job.frames(&dance)?;
    if !job.project.recording.seamless {
        dance.play_once(&frames, &mut problems);
    }
    report_progress(progress, Progress::Loaded { problems: problems.clone() })?;
    if request.frame_body
        && let Some(camera) = camera_for_size(&job.project.camera, 1.0, dance.scene().hair_scale)
    {
        job.project.camera = camera;
    }

    let sound = if job.kind == OutputKind::Preview {
        let heard = job.project.sound.is_heard();
        problems
            .extend(heard.then(|| Problem::new(Place::Sound, ProblemKind::Note, "a preview has no sound")));
        None
    } else {
        FilmSound::of(&job.project, &request.access, &dance, &frames, &mut problems, progress)?
    };
    // After the checks of the request, because drivers may print to standard error when they are opened.
    let mut drawer = Drawer::open(&job.project, request)?;
    if job.project.recording.seamless {
        dance.close(&frames)?;
    }

    let has_sound = sound.is_some();
    let refused = |error: RecordError| job.refused(&error);
    // Created before the sink, so that it is dropped after it.
    let _new_folders = NewFolders::missing_on(&request.out);
    let settings = job.sink_settings(&frames, &dance, &drawer)?;
    let mut sink = PictureSink::for_path(&request.out, settings).map_err(refused)?;
    if let Some(sound) = sound {
        sink.set_sound(Box::new(sound)).map_err(refused)?;
    }
    let mut tally = Tally::new(((frames.end - frames.start) as usize).min(MAX_TIMES));
    if let Err(error) = job.write(&frames, &mut dance, &mut drawer, &mut sink, &mut tally, progress) {
        // Nobody wanted this, so what there is can be kept.
        if !matches!(error, ProjectError::Cancelled) {
            sink.leave();
        }
        return Err(error);
    }
    report_progress(progress, Progress::Finishing)?;
    let written = sink.finish().map_err(refused)?;

    problems.extend(dance.notices());
    let totals = dance.totals();
    let strands = &dance.scene().style.strands;
    Ok(RecordReport {
        out: request.out.clone(),
        frames: written.frames(),
        frames_kept: written.kept(),
        first_frame: frames.start,
        fps: job.fps,
        width: job.width,
        height: job.height,
        backend: drawer.backend(),
        adapter: drawer.adapter().to_owned(),
        shadow: job.project.shadow.method.to_string(),
        draw: job.project.picture.draw.to_string(),
        transparency: job.project.picture.transparency.to_string(),
        format: job.format().to_owned(),
        sound: has_sound,
        transparent: job.options.transparent,
        motion_blur: job.options.subframes,
        lens_samples: job.options.lens_samples,
        shutter_degrees: job.options.shutter_degrees,
        strands: strands.count() as u64,
        segments: strands.segments() as u64,
        frame_ms: lovelock_base::statistics::median(tally.whole_ms).unwrap_or(0.0),
        stage_ms: tally.history.medians(),
        passes_ms: tally.passes.medians().into_iter().map(|pass| (pass.name, pass.ms)).collect(),
        shadow_bytes: tally.shadow_bytes,
        draw_bytes: tally.draw_bytes,
        max_stretch: totals.max_stretch,
        max_penetration_m: totals.max_penetration_m,
        recovered_guides: totals.recovered_guides,
        health: dance.health(),
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
    options: Options,
    kind: OutputKind,
    fps: f64,
    width: u32,
    height: u32,
}

impl<'a> Job<'a> {
    /// Checks the request before anything is loaded.
    fn new(project: &Project, request: &'a RecordRequest) -> Result<Self, ProjectError> {
        let (mut project, _) = project.sanitised();
        if let Some(shadow) = request.shadow {
            project.shadow.method = shadow;
        }
        project.recording.seamless |= request.seamless;
        if let Some(secs) = request.turn_secs {
            (project.camera.turntable, project.camera.turn_secs) = (true, secs);
        }
        if let Some(draw) = request.draw {
            project.picture.draw = draw;
        }
        if let Some(transparency) = request.transparency {
            project.picture.transparency = transparency;
        }
        let fps = request.fps.unwrap_or(project.recording.fps);
        let (width, height) = request.size.unwrap_or((project.recording.width, project.recording.height));
        let refused = |error: &RecordError| refused(request, error);
        let kind = OutputKind::of(&request.out).map_err(|error| refused(&error))?;
        let options = Options::new(&project, request)?;
        if request.dance_time && project.recording.seamless {
            return Err(ProjectError::option("--dance-time: cannot be combined with a seamless loop"));
        }
        let job = Self { project, request, options, kind, fps, width, height };
        lovelock_render::check_size(width, height)?;
        FrameRate::from_fps(fps).map_err(|error| job.refused(&error))?;
        if let Some(frames) = &request.frames {
            check_frames(frames)?;
        }
        let mut asked = job.sink_basics(1);
        // A project that prefers EXR can still be recorded as a film.
        asked.format = request.format.unwrap_or_default();
        asked.check_kind(kind).map_err(|error| job.refused(&error))?;
        let layered = job.options.transparent
            || job.options.subframes > 1
            || job.options.lens_samples > 1
            || (kind == OutputKind::Sequence && job.options.format == SequenceFormat::Exr);
        if request.panes.is_some() && layered {
            return Err(ProjectError::option(PANES_ALONE));
        }
        if kind == OutputKind::Preview {
            // The number of frames is known after loading.
            let frames = request.frames.as_ref().map_or(1, |frames| frames.end - frames.start);
            lovelock_record::PreviewSettings { width, height, fps, frames, alpha: job.options.transparent }
                .check()
                .map_err(|error| job.refused(&error))?;
        }
        if kind == OutputKind::Film {
            let quality = job.options.quality;
            lovelock_record::FilmSettings { width, height, fps, quality }
                .check()
                .map_err(|error| job.refused(&error))?;
        }
        Ok(job)
    }

    /// The frames of the request, or of the project, or of the whole clip.
    fn frames(&self, dance: &Dance) -> Result<std::ops::Range<u64>, ProjectError> {
        let recording = &self.project.recording;
        let frames = self.request.frames.clone().unwrap_or_else(|| {
            let first = recording.first_frame.max(dance.first_frame());
            if let Some(secs) = self.request.turn_secs {
                // The frame after the last one would show the first again.
                let turn = (f64::from(secs) * self.fps).round().max(1.0) as u64;
                return first..first.saturating_add(turn);
            }
            let count = if recording.seamless { dance.frames_of_round() } else { dance.frames() };
            let end = dance.first_frame() + count;
            first..recording.end_frame.unwrap_or_else(|| end.max(first + 1))
        });
        check_frames(&frames)?;
        dance.check(&frames)?;
        Ok(frames)
    }

    /// Settings of the output except the renderer.
    fn sink_basics(&self, frames: u64) -> SinkSettings {
        let mut settings = SinkSettings::new(self.width, self.height, self.fps);
        settings.frames = frames;
        settings.quality = self.options.quality;
        settings.format =
            if self.kind == OutputKind::Sequence { self.options.format } else { SequenceFormat::Png };
        settings.alpha = self.options.transparent;
        settings.resume = self.request.resume;
        settings
    }

    /// The same with everything that its pixels depend on.
    fn sink_settings(
        &self,
        frames: &std::ops::Range<u64>,
        dance: &Dance,
        drawer: &Drawer,
    ) -> Result<SinkSettings, ProjectError> {
        let mut settings = self.sink_basics(frames.end - frames.start);
        settings.first_frame = frames.start;
        if self.kind != OutputKind::Sequence {
            return Ok(settings);
        }
        let with_panes = self.request.panes.is_some();
        let mut told = serde_json::json!({
            "program": concat!("lovelock ", env!("CARGO_PKG_VERSION")),
            "backend": drawer.kind(),
            "shadow": self.project.shadow.method.id(),
            "draw": self.project.picture.draw.to_string(),
            "transparency": self.project.picture.transparency.id(),
            "format": self.options.format.id(),
            "background": if self.options.transparent { "transparent" } else { "drawn" },
            "motion blur": self.options.subframes,
            "shutter": self.options.shutter_degrees,
            "lens": self.options.lens_samples,
            "label": self.options.label,
            "project": fingerprint::of_project(&self.project, with_panes)?,
            "files": fingerprint::of_files(&self.project, &self.request.access, dance.take_assets(), with_panes),
        });
        if self.request.dance_time {
            told["frames"] = "of the dance".into();
        }
        settings.settings = told;
        Ok(settings)
    }

    /// Whether frames are rendered as layers, which is needed for linear light and transparency.
    fn is_layered(&self) -> bool {
        self.options.subframes > 1
            || self.options.lens_samples > 1
            || self.options.transparent
            || self.format() == SequenceFormat::Exr.id()
    }

    /// The format by extension.
    fn format(&self) -> &'static str {
        match self.kind {
            OutputKind::Film => "mp4",
            OutputKind::Preview => "apng",
            OutputKind::Sequence => self.options.format.id(),
        }
    }

    /// Draws the frames and writes them.
    fn write(
        &self,
        frames: &std::ops::Range<u64>,
        dance: &mut Dance,
        drawer: &mut Drawer,
        sink: &mut PictureSink,
        tally: &mut Tally,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), ProjectError> {
        let mut begun = false;
        let mut drawn = Drawn::default();
        let total = frames.end - frames.start;
        let mut in_flight: Option<Begun> = None;
        for frame in frames.clone() {
            if sink.next_is_kept() {
                sink.keep_next();
                report_progress(progress, Progress::Kept { done: frame + 1 - frames.start, total })?;
                continue;
            }
            if !std::mem::replace(&mut begun, true) {
                // Simulate all earlier frames of the recording, whether they are kept or not.
                dance.begin(frames.start, self.options.instants(frame, self.fps)[0], progress)?;
                tally.since = Stopwatch::start();
            }
            // While a graphics card draws this frame, the one before is written.
            let before = std::mem::replace(&mut in_flight, self.begin(frame, dance, drawer)?);
            let mut finished = None;
            if let Some(before) = before {
                finished = Some((before.frame, self.finish(before, drawer, &mut drawn)?));
            } else if in_flight.is_none() {
                finished = Some((frame, self.draw(frame, dance, drawer, &mut drawn)?));
            }
            if let Some((frame, made)) = finished {
                tally.write(self, &drawn, made, sink)?;
                let (done, steps_per_frame) = (frame + 1 - frames.start, dance.steps_per_frame());
                report_progress(progress, Progress::Frame { done, total, steps_per_frame })?;
            }
        }
        if let Some(last) = in_flight {
            let made = self.finish(last, drawer, &mut drawn)?;
            tally.write(self, &drawn, made, sink)?;
            report_progress(
                progress,
                Progress::Frame { done: total, total, steps_per_frame: dance.steps_per_frame() },
            )?;
        }
        Ok(())
    }

    /// Starts to render a frame on a graphics card; `None` where frames are rendered at once by [`Job::draw`].
    fn begin(
        &self,
        frame: u64,
        dance: &mut Dance,
        drawer: &mut Drawer,
    ) -> Result<Option<Begun>, ProjectError> {
        // With frames that are kept in between, the next to be written would not be the one in flight.
        if self.is_layered() || self.request.resume || !drawer.begins() {
            return Ok(None);
        }
        let snapshot = dance.snapshot(frame)?;
        let project = self.project.seen_at(snapshot.position_secs).into_owned();
        let pending = drawer.begin(&project, &snapshot, [self.width, self.height])?;
        Ok(pending.map(|pending| Begun { frame, project, snapshot, pending }))
    }

    /// Finishes a frame that was begun.
    fn finish(
        &self,
        Begun { frame, project, snapshot, pending }: Begun,
        drawer: &mut Drawer,
        drawn: &mut Drawn,
    ) -> Result<(StageTimes, FrameStats), ProjectError> {
        let size = [self.width, self.height];
        let stats = drawer.finish(pending, (&project, &snapshot), size, &mut drawn.picture)?;
        if self.options.label {
            burn_in(&mut drawn.picture, &self.label(frame));
        }
        let mut times = snapshot.times;
        times.take_picture(&stats);
        Ok((times, stats))
    }

    /// Renders a frame: one image, or the mean of the samples while the shutter is open.
    fn draw(
        &self,
        frame: u64,
        dance: &mut Dance,
        drawer: &mut Drawer,
        drawn: &mut Drawn,
    ) -> Result<(StageTimes, FrameStats), ProjectError> {
        let size = [self.width, self.height];
        if !self.is_layered() {
            let snapshot = dance.snapshot(frame)?;
            let at = self.project.seen_at(snapshot.position_secs);
            let stats = drawer.picture(&at, &snapshot, size, &mut drawn.picture)?;
            if self.options.label {
                burn_in(&mut drawn.picture, &self.label(frame));
            }
            let mut times = snapshot.times;
            times.take_picture(&stats);
            return Ok((times, stats));
        }
        let over_background = !self.options.transparent;
        let instants = self.options.instants(frame, self.fps);
        // Each instant has its own places of the aperture.
        let per_instant = self.options.lens_samples.div_ceil(instants.len() as u32).max(1);
        let whole = instants.len() as u32 * per_instant;
        let weight = 1.0 / whole as f32;
        let needs_values = self.format() == SequenceFormat::Exr.id();
        let (mut times, mut last) = (StageTimes::default(), FrameStats::default());
        drawn.mean.clear_to(self.width, self.height);
        for (instant, &secs) in instants.iter().enumerate() {
            // Without blur a frame equals the single image bit for bit.
            let snapshot =
                if instants.len() == 1 { dance.snapshot(frame)? } else { dance.snapshot_at(secs)? };
            let at = self.project.seen_at(snapshot.position_secs);
            times.motion += snapshot.times.motion;
            times.simulate += snapshot.times.simulate;
            if whole == 1 {
                last = drawer.layers(&at, &snapshot, size, over_background, &mut drawn.mean)?;
                times.add_picture(&last);
                continue;
            }
            for sample in 0..per_instant {
                let index = instant as u32 + sample * instants.len() as u32;
                // Values of the middle of the lens stand for all: they belong to what is in focus.
                let with_values = sample == 0 && (needs_values || per_instant == 1);
                let wanted = (over_background, index, with_values);
                last = drawer.lens_sample(&at, &snapshot, size, wanted, &mut drawn.one)?;
                times.add_picture(&last);
                if with_values {
                    drawn.mean.add_values(&drawn.one, 1.0 / instants.len() as f32);
                }
                drawn.mean.add_light(&drawn.one, weight);
            }
        }
        if self.format() == SequenceFormat::Exr.id() {
            if self.options.label {
                burn_in_light(&mut drawn.mean, &self.label(frame));
            }
        } else {
            drawn.mean.tone_map(&mut drawn.picture);
            if self.options.label {
                burn_in(&mut drawn.picture, &self.label(frame));
            }
        }
        Ok((times, last))
    }

    /// Writes the last rendered frame.
    fn push(&self, drawn: &Drawn, sink: &mut PictureSink) -> Result<(), RecordError> {
        if self.format() != SequenceFormat::Exr.id() {
            return sink.push(&drawn.picture.rgba);
        }
        let Layers { light, depth, transmittance, .. } = &drawn.mean;
        sink.push_layers(&FrameLayers { light, depth, transmittance })
    }

    /// The label of a frame.
    fn label(&self, frame: u64) -> String {
        let (shadow, transparency) =
            (self.project.shadow.method.label(), self.project.picture.transparency.label());
        let draw = match self.project.picture.draw {
            HairDrawing::Strands => String::new(),
            other => format!("{} · ", other.names().1),
        };
        format!("{draw}{shadow} · {transparency} · frame {frame} · {:.2} s", frame as f64 / self.fps)
    }

    fn refused(&self, error: &RecordError) -> ProjectError {
        refused(self.request, error)
    }
}

fn refused(request: &RecordRequest, error: &RecordError) -> ProjectError {
    let file = error.path().map(Path::to_owned);
    if error.is_request() {
        let file = file.or_else(|| Some(request.out.clone()));
        ProjectError::Request { file, message: error.to_string() }
    } else {
        ProjectError::Work { file, message: error.to_string() }
    }
}

/// What the written frames cost.
struct Tally {
    history: StageHistory,
    passes: PassHistory,
    /// The largest of any frame, bytes.
    shadow_bytes: u64,
    draw_bytes: u64,
    /// Time from one written frame to the next, milliseconds.
    whole_ms: Vec<f64>,
    since: Stopwatch,
}

impl Tally {
    /// For at most `most` frames in the medians.
    fn new(most: usize) -> Self {
        Self {
            history: StageHistory::new(most),
            passes: PassHistory::new(most),
            shadow_bytes: 0,
            draw_bytes: 0,
            whole_ms: Vec::new(),
            since: Stopwatch::start(),
        }
    }

    /// Writes a frame that was drawn.
    fn write(
        &mut self,
        job: &Job,
        drawn: &Drawn,
        (mut times, stats): (StageTimes, FrameStats),
        sink: &mut PictureSink,
    ) -> Result<(), ProjectError> {
        let encoding = Stopwatch::start();
        job.push(drawn, sink).map_err(|error| job.refused(&error))?;
        times.encode = encoding.ms();
        self.history.push(times);
        self.passes.push(&stats.passes);
        self.shadow_bytes = self.shadow_bytes.max(stats.shadow_bytes);
        self.draw_bytes = self.draw_bytes.max(stats.draw_bytes);
        self.whole_ms.push(self.since.lap_ms());
        Ok(())
    }
}

/// A frame that a graphics card draws.
struct Begun {
    frame: u64,
    project: Project,
    snapshot: Arc<FrameSnapshot>,
    pending: PendingPicture,
}

/// Buffers of a frame: its bytes, its layers, and the layers of one sample.
#[derive(Default)]
struct Drawn {
    picture: Picture,
    mean: Layers,
    one: Layers,
}
