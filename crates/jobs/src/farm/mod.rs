//! `lovelock farm`: writes a job folder for rendering on many machines, by any scheduler for the Open Job Description.
//!
//! It contains the project with its files, and a job of three steps: simulate once into a take, render ranges of frames in
//! parallel, and assemble them. See docs/farm.md.

mod assets;
mod template;

use std::fs;
use std::ops::{ControlFlow, Range};
use std::path::{Path, PathBuf};

use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProblemKind, ProjectError};
use lovelock_project::files::{Access, FileRef, write_whole};
use lovelock_project::project::{PROJECT_EXTENSION, save_project};
use lovelock_record::{FrameRate, SequenceReport, join_sequences};
use lovelock_session::dance::Dance;
use lovelock_session::prepare::check_frames;
use lovelock_session::progress::{Progress, report_progress};
use serde::Serialize;
use template::{Source, Template};

/// File name of the job.
pub const FARM_TEMPLATE: &str = "template.json";
/// File name of the take that the job simulates.
const TAKE: &str = "dance.take";
/// Maximum number of tasks per step in the Open Job Description.
const MAX_TASKS: u64 = 1024;

/// What to render. `None` uses the project's value.
#[derive(Clone, Debug, Default)]
pub struct FarmRequest {
    /// The folder, which must be new or empty.
    pub out: PathBuf,
    /// Frames, half open.
    pub frames: Option<Range<u64>>,
    /// Frames per second.
    pub fps: Option<f64>,
    /// Width and height, pixels.
    pub size: Option<(u32, u32)>,
    /// Frames per task; by default 10, or more if there would be too many tasks.
    pub chunk: Option<u64>,
    /// The files that the project may read.
    pub access: Access,
}

/// The result, as `farm --json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FarmReport {
    /// The folder.
    pub out: String,
    /// Path of the job.
    pub template: String,
    /// Number of the first frame.
    pub first_frame: u64,
    /// Number of frames.
    pub frames: u64,
    /// Frames per second.
    pub fps: f64,
    /// Frames per task.
    pub chunk: u64,
    /// Number of rendering tasks.
    pub tasks: u64,
    /// Names of the steps.
    pub steps: Vec<String>,
    /// Copied files with their sizes in bytes.
    pub copied: Vec<(String, u64)>,
    /// Notes, as sentences.
    pub notes: Vec<String>,
}

/// Writes the folder of a job. It gets its final name when it is complete.
///
/// # Errors
/// If the folder is not empty, the range is outside the take, files of the project are missing, or the disk is full. Nothing is
/// left behind then.
pub fn farm(
    project: &Project,
    request: &FarmRequest,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<FarmReport, ProjectError> {
    let (mut project, _) = project.sanitised();
    // The machines write images, and a folder of images is joined without a sound.
    let loses_sound = project.sound.is_heard();
    project.sound = lovelock_project::project::SoundSection::default();
    let out = &request.out;
    check_folder(out)?;
    if let Some((width, height)) = request.size {
        lovelock_render::check_size(width, height)?;
        (project.recording.width, project.recording.height) = (width, height);
    }
    let fps = request.fps.unwrap_or(project.recording.fps);
    FrameRate::from_fps(fps).map_err(ProjectError::option)?;
    if request.chunk == Some(0) {
        return Err(ProjectError::option("--chunk: found 0; must be 1 or more"));
    }
    if let Some(frames) = &request.frames {
        check_frames(frames)?;
    }
    if project.recording.seamless {
        return Err(ProjectError::option(
            "a seamless loop: its end is blended into its start, which tasks cannot do separately; record it on one machine, or \
             switch it off in the project",
        ));
    }
    project.recording.fps = fps;
    // A file that is missing here is missing on every machine, so check before the job is submitted.
    for (place, file) in project.files() {
        request.access.read(place, file).map_err(|problem| ProjectError::input(&file.path, problem.cause))?;
    }
    let (dance, mut problems) = Dance::open(&project, &request.access, fps, progress)?;
    let silent = "the frames of a farm have no sound; add the file when you make a film of them";
    problems.extend(loses_sound.then(|| Problem::new(Place::Sound, ProblemKind::Note, silent)));
    if let Some(problem) = problems.iter().find(|problem| problem.is_failure()) {
        return Err(ProjectError::option(format!("a part of the scene is missing: {}", problem.cause)));
    }
    let frames = request.frames.clone().unwrap_or_else(|| project.recording.frame_range(dance.frames()));
    check_frames(&frames)?;
    dance.check(&frames)?;
    let count = frames.end - frames.start;
    let least = count.div_ceil(MAX_TASKS);
    let chunk = request.chunk.unwrap_or(10.max(least)).min(count);
    if chunk < least {
        return Err(ProjectError::option(format!(
            "--chunk {chunk}: {} tasks for {count} frames, but a job has {MAX_TASKS} at most; must be {least} or more",
            count.div_ceil(chunk)
        )));
    }

    let building = Building::start(out)?;
    let mut copied = Vec::new();
    let source = if let Some(take) = &project.take.file {
        if lovelock_session::take::holds_curves(&take.path) {
            let found =
                format!("{}: found curves over time; a job needs a project or a take", take.path.display());
            return Err(ProjectError::input(&take.path, found));
        }
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
    let text = serde_json::to_string_pretty(&template.json()).map_err(ProjectError::work)?;
    write_whole(&building.folder.join(FARM_TEMPLATE), format!("{text}\n").as_bytes())?;
    report_progress(progress, Progress::Finishing)?;
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

/// Assembles the parts that a job has rendered; see [`join_sequences`].
///
/// # Errors
/// As [`join_sequences`].
pub fn assemble(parts: &Path, frames: Range<u64>, out: &Path) -> Result<SequenceReport, ProjectError> {
    join_sequences(parts, frames, out).map_err(|error| {
        let file = Some(error.path().unwrap_or(parts).to_owned());
        let message = error.to_string();
        if error.is_request() {
            ProjectError::Request { file, message }
        } else {
            ProjectError::Work { file, message }
        }
    })
}

/// Rejects a project that renders a take with settings other than those in the take, because the machines render the take.
fn as_recorded(project: &Project, take: &Path) -> Result<(), ProjectError> {
    let (own, _) = lovelock_session::take::project_of_take(take)?;
    let (own, _) = own.sanitised();
    let drawn = |project: &Project| lovelock_project::project::RecordingSection {
        // Size and rate are part of the job, and the other fields do not affect images.
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
        Some((_, part)) => Err(ProjectError::option(format!(
            "the {part} of the project are not those that {} was recorded with, and a job renders a take as recorded; leave \
             the take, and the job simulates the project itself",
            take.display()
        ))),
    }
}

/// Rejects a folder that is not empty.
fn check_folder(out: &Path) -> Result<(), ProjectError> {
    if out.file_name().is_none() {
        return Err(ProjectError::option("-o: the folder has no name; must be a new folder"));
    }
    match fs::read_dir(out).map(Iterator::count) {
        Ok(0) => Ok(()),
        Ok(_) => Err(ProjectError::input(
            out,
            format!("{}: is not empty; must be a new or empty folder for the job", out.display()),
        )),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Err(error) => {
            Err(ProjectError::input(out, format!("{}: no folder for the job: {error}", out.display())))
        }
    }
}

/// A folder that is filled under a temporary name. Dropping it before [`Building::finish`] removes it.
struct Building {
    folder: PathBuf,
    target: PathBuf,
    done: bool,
}

impl Building {
    fn start(target: &Path) -> Result<Self, ProjectError> {
        let mut name = target.file_name().unwrap_or_default().to_owned();
        name.push(".partial");
        let folder = target.with_file_name(name);
        let failed = |error: std::io::Error| {
            ProjectError::output(&folder, format!("{}: could not be made: {error}", folder.display()))
        };
        if folder.exists() {
            return Err(ProjectError::input(
                &folder,
                format!(
                    "{}: already exists, from a job that is being written or was interrupted; remove it or name another folder",
                    folder.display()
                ),
            ));
        }
        fs::create_dir_all(&folder).map_err(failed)?;
        Ok(Self { folder: folder.clone(), target: target.to_owned(), done: false })
    }

    fn finish(mut self) -> Result<(), ProjectError> {
        let failed = |error: std::io::Error| {
            ProjectError::output(
                &self.target,
                format!("{}: could not get its name: {error}", self.target.display()),
            )
        };
        if self.target.exists() {
            // It is empty, as checked before.
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
