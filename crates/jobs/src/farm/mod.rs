//! `lovelock farm`: a folder that any scheduler of the Open Job Description draws on many machines.
//!
//! It holds the project with its files and a job of three steps: simulate once into a take, draw ranges of frames in
//! parallel, put them together. See docs/farm.md.

mod assets;
mod template;

use std::fs;
use std::ops::{ControlFlow, Range};
use std::path::{Path, PathBuf};

use lovelock_project::Project;
use lovelock_project::error::StudioError;
use lovelock_project::files::{Access, FileRef, write_whole};
use lovelock_project::project::{PROJECT_EXTENSION, save_project};
use lovelock_record::{FrameRate, SequenceReport, join_sequences};
use lovelock_session::dance::Dance;
use lovelock_session::prepare::check_frames;
use lovelock_session::progress::{Progress, tell};
use serde::Serialize;
use template::{Source, Template};

/// The job, in the folder.
pub const FARM_TEMPLATE: &str = "template.json";
/// The take that the job simulates, in the folder.
const TAKE: &str = "dance.take";
/// The most tasks of one step that the Open Job Description allows.
const MOST_TASKS: u64 = 1024;

/// What is to be drawn on many machines; where a field is none, the project says.
#[derive(Clone, Debug, Default)]
pub struct FarmRequest {
    /// The folder, which is not there yet or empty.
    pub out: PathBuf,
    /// Frames, half open.
    pub frames: Option<Range<u64>>,
    /// Frames a second.
    pub fps: Option<f64>,
    /// Width and height, pixels.
    pub size: Option<(u32, u32)>,
    /// Frames that one task draws; 10, or more where there would be too many tasks.
    pub chunk: Option<u64>,
    /// What the project may read.
    pub access: Access,
}

/// What was written, as `farm --json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FarmReport {
    /// The folder.
    pub out: String,
    /// The job in it.
    pub template: String,
    /// Number of the first frame.
    pub first_frame: u64,
    /// Frames.
    pub frames: u64,
    /// Frames a second.
    pub fps: f64,
    /// Frames that one task draws.
    pub chunk: u64,
    /// Tasks that draw.
    pub tasks: u64,
    /// Names of the steps.
    pub steps: Vec<String>,
    /// Files that were copied, and their bytes.
    pub copied: Vec<(String, u64)>,
    /// What to know, in sentences.
    pub notes: Vec<String>,
}

/// Writes the folder of a job. It appears under its name when it is whole.
///
/// # Errors
/// A folder that holds something, a range outside a take, files of the project that are missing, and a disk that
/// takes no more; nothing is left then.
pub fn farm(
    project: &Project,
    request: &FarmRequest,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<FarmReport, StudioError> {
    let (mut project, _) = project.sanitised();
    let out = &request.out;
    check_folder(out)?;
    if let Some((width, height)) = request.size {
        lovelock_render::check_size(width, height)?;
        (project.recording.width, project.recording.height) = (width, height);
    }
    let fps = request.fps.unwrap_or(project.recording.fps);
    FrameRate::from_fps(fps).map_err(StudioError::option)?;
    if request.chunk == Some(0) {
        return Err(StudioError::option("--chunk 0: no frames a task; wanted 1 or more"));
    }
    if let Some(frames) = &request.frames {
        check_frames(frames)?;
    }
    if project.recording.seamless {
        return Err(StudioError::option(
            "a seamless loop: its end goes over into its start, which parts know nothing of; record it on one machine, or \
             switch it off in the project",
        ));
    }
    project.recording.fps = fps;
    // What is missing here is missing on every machine. To ask now is cheaper than to find out there.
    for (place, file) in project.files() {
        request.access.read(place, file).map_err(|problem| StudioError::input(&file.path, problem.cause))?;
    }
    let (dance, problems) = Dance::open(&project, &request.access, fps, progress)?;
    if let Some(problem) = problems.iter().find(|problem| problem.is_failure()) {
        return Err(StudioError::option(format!("a part of the scene is missing: {}", problem.cause)));
    }
    let recording = &project.recording;
    let frames = request.frames.clone().unwrap_or_else(|| {
        let first = recording.first_frame;
        first..recording.end_frame.unwrap_or_else(|| dance.frames().max(first + 1))
    });
    check_frames(&frames)?;
    dance.check(&frames)?;
    let count = frames.end - frames.start;
    let least = count.div_ceil(MOST_TASKS);
    let chunk = request.chunk.unwrap_or(10.max(least)).min(count);
    if chunk < least {
        return Err(StudioError::option(format!(
            "--chunk {chunk}: {} tasks for {count} frames, and a job has {MOST_TASKS} at most; wanted {least} or more",
            count.div_ceil(chunk)
        )));
    }

    let building = Building::start(out)?;
    let mut copied = Vec::new();
    let source = if let Some(take) = &project.take.file {
        as_recorded(&project, &take.path)?;
        Source::Take(take.path.clone(), [project.recording.width, project.recording.height])
    } else {
        copied = assets::copy(&mut project, &building.folder, progress)?;
        project.recording.output = None::<FileRef>;
        save_project(&building.folder.join(format!("project.{PROJECT_EXTENSION}")), &project)?;
        Source::Project
    };
    let name = out.file_name().map_or_else(|| "dance".to_owned(), |name| name.to_string_lossy().into_owned());
    let blurred = project.recording.subframes > 1;
    let simulated_from = frames.start.saturating_sub(u64::from(blurred));
    let template = Template { name, source, frames: frames.clone(), fps, chunk, simulated_from };
    let text = serde_json::to_string_pretty(&template.json()).map_err(StudioError::work)?;
    write_whole(&building.folder.join(FARM_TEMPLATE), format!("{text}\n").as_bytes())?;
    tell(progress, Progress::Finishing)?;
    building.finish()?;
    Ok(FarmReport {
        out: out.display().to_string(),
        template: out.join(FARM_TEMPLATE).display().to_string(),
        first_frame: frames.start,
        frames: count,
        fps,
        chunk,
        tasks: count.div_ceil(chunk),
        steps: template.steps().into_iter().map(str::to_owned).collect(),
        copied,
        notes: problems.iter().map(ToString::to_string).collect(),
    })
}

/// Puts the parts that a job has drawn together; see [`join_sequences`].
///
/// # Errors
/// As [`join_sequences`].
pub fn assemble(parts: &Path, frames: Range<u64>, out: &Path) -> Result<SequenceReport, StudioError> {
    join_sequences(parts, frames, out).map_err(|error| {
        let file = Some(error.path().unwrap_or(parts).to_owned());
        let message = error.to_string();
        if error.is_request() {
            StudioError::Request { file, message }
        } else {
            StudioError::Work { file, message }
        }
    })
}

/// Refuses a project that shows a take in another way than the take's own project, which is what the machines draw.
fn as_recorded(project: &Project, take: &Path) -> Result<(), StudioError> {
    let (own, _) = lovelock_session::take::project_of_take(take)?;
    let (own, _) = own.sanitised();
    let drawn = |project: &Project| lovelock_project::project::RecordingSection {
        // Size and rate go into the job, and the rest of these draws nothing.
        width: 0,
        height: 0,
        fps: 0.0,
        first_frame: 0,
        end_frame: None,
        output: None,
        ..project.recording.clone()
    };
    let parts = [
        (drawn(project) == drawn(&own), "recording settings"),
        (project.look == own.look, "look"),
        (project.lights == own.lights, "lights"),
        (project.shadow == own.shadow, "shadow"),
        (project.camera == own.camera, "camera"),
        (project.picture == own.picture, "picture"),
        (project.timeline.tracks == own.timeline.tracks, "tracks"),
    ];
    match parts.iter().find(|(same, _)| !same) {
        None => Ok(()),
        Some((_, part)) => Err(StudioError::option(format!(
            "the {part} of the project are not those that {} was recorded with, and a job draws a take as it was recorded; \
             leave the take, and the job simulates the project itself",
            take.display()
        ))),
    }
}

/// Refuses a name that is taken, so that nothing is lost.
fn check_folder(out: &Path) -> Result<(), StudioError> {
    if out.file_name().is_none() {
        return Err(StudioError::option("-o: the folder has no name; wanted a new folder"));
    }
    match fs::read_dir(out).map(Iterator::count) {
        Ok(0) => Ok(()),
        Ok(_) => Err(StudioError::input(
            out,
            format!("{}: is not empty; wanted a new or empty folder for the job", out.display()),
        )),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Err(error) => {
            Err(StudioError::input(out, format!("{}: no folder for the job: {error}", out.display())))
        }
    }
}

/// A folder that is filled beside its name. Dropped before [`Building::finish`], it leaves nothing.
struct Building {
    folder: PathBuf,
    target: PathBuf,
    done: bool,
}

impl Building {
    fn start(target: &Path) -> Result<Self, StudioError> {
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(".partial");
        let folder = target.with_file_name(name);
        let failed = |error: std::io::Error| {
            StudioError::output(&folder, format!("{}: could not be made: {error}", folder.display()))
        };
        if folder.exists() {
            return Err(StudioError::input(
                &folder,
                format!(
                    "{}: is there already, from a job that is being written or was cut short; remove it or name another folder",
                    folder.display()
                ),
            ));
        }
        fs::create_dir_all(&folder).map_err(failed)?;
        Ok(Self { folder: folder.clone(), target: target.to_owned(), done: false })
    }

    fn finish(mut self) -> Result<(), StudioError> {
        let failed = |error: std::io::Error| {
            StudioError::output(
                &self.target,
                format!("{}: could not get its name: {error}", self.target.display()),
            )
        };
        if self.target.exists() {
            // Empty: it was looked at.
            fs::remove_dir(&self.target).map_err(failed)?;
        }
        fs::rename(&self.folder, &self.target).map_err(failed)?;
        self.done = true;
        Ok(())
    }
}

impl Drop for Building {
    fn drop(&mut self) {
        if !self.done {
            let _ = fs::remove_dir_all(&self.folder);
        }
    }
}

#[cfg(test)]
mod tests;
