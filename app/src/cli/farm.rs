//! `lovelock farm` and `lovelock assemble`.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;
use lovelock_base::words::counted;
use lovelock_jobs::farm::{FarmReport, FarmRequest, assemble, farm};
use lovelock_project::error::ProjectError;

use super::args::{FilmArguments, SourceArguments, frames};
use super::output::Output;
use super::replace::{self, Holds};
use super::source::Source;

#[derive(Debug, Args)]
pub(crate) struct Farm {
    #[command(flatten)]
    pub(crate) source: SourceArguments,
    /// Folder for the job, new or empty: template.json and the project with its files.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) film: FilmArguments,
    /// Frames per task; 10, or more if that would make more than 1024 tasks.
    #[arg(long, value_name = "N")]
    pub(crate) chunk: Option<u64>,
}

#[derive(Debug, Args)]
pub(crate) struct Assemble {
    /// Folder whose subfolders contain the parts.
    pub(crate) parts: PathBuf,
    /// Folder for the joined sequence.
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Frames of the whole sequence, half open.
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub(crate) frames: Range<u64>,
    /// Replace images that this program did not make.
    #[arg(long)]
    pub(crate) force: bool,
}

/// Writes the folder of a job.
pub(crate) fn run(task: &Farm, output: Output) -> Result<(), ProjectError> {
    let mut scene = Source::open(&task.source)?;
    let request = FarmRequest {
        out: task.out.clone(),
        frames: task.film.frames.clone(),
        fps: task.film.picture.fps,
        size: task.film.picture.size,
        chunk: task.chunk,
        access: std::mem::take(&mut scene.access),
    };
    let report = scene.watched(|project, progress| farm(project, &request, progress))?;
    output.result(&report, || summary(&report))
}

/// Joins rendered parts.
pub(crate) fn run_assemble(task: &Assemble, output: Output) -> Result<(), ProjectError> {
    let replaced = replace::check(&task.out, Holds::Images, task.force)?;
    let report = assemble(&task.parts, task.frames.clone(), &task.out)?;
    replaced.tell();
    let json = serde_json::json!({
        "out": report.folder.display().to_string(),
        "first_frame": task.frames.start,
        "frames": report.frames,
        "bytes": report.bytes,
    });
    output.result(&json, || {
        format!("{}: {}", report.folder.display(), counted(report.frames, "frame", "frames"))
    })
}

fn summary(report: &FarmReport) -> String {
    format!(
        "{}: frames {}..{} at {} per second in {} tasks of {} frames; steps {}\n\
         try it here with: openjd run {} --step Assemble --run-dependencies",
        report.template,
        report.first_frame,
        report.first_frame + report.frames,
        report.fps,
        report.tasks,
        report.chunk,
        report.steps.join(", "),
        report.template,
    )
}
