//! `lovelock farm` and `lovelock assemble`.

use lovelock_base::words::counted;
use lovelock_jobs::farm::{FarmReport, FarmRequest, assemble, farm};
use lovelock_project::error::ProjectError;

use super::args::{Assemble, Farm};
use super::output::Output;
use super::replace::{self, Holds};
use super::source::Source;

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
