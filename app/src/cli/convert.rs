//! `lovelock convert`.

use lovelock_jobs::convert::convert;
use lovelock_project::error::ProjectError;

use super::args::Convert;
use super::output::Output;
use super::replace::Holds;

/// Converts a hair file to another format.
pub(crate) fn run(task: &Convert, output: Output) -> Result<(), ProjectError> {
    let replaced = super::replace::check(&task.out, Holds::Work("hair"), task.force)?;
    let report = convert(&task.input, &task.out, task.unit, task.up, task.include_hidden)?;
    replaced.tell();
    output.result(&report, || {
        let lines: Vec<String> = report.notes.iter().map(|note| format!("\n{note}")).collect();
        format!("{}: {} strands of {} points{}", report.out, report.strands, report.points, lines.concat())
    })
}
