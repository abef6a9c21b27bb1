//! `lovelock papers`.

use std::ops::ControlFlow;

use lovelock_jobs::papers::{PapersReport, PapersRequest, papers};
use lovelock_project::error::ProjectError;

use super::args::Papers;
use super::bar::Bar;
use super::output::Output;
use super::replace::{self, Holds};

/// Makes the gallery; an error if a claim does not hold.
pub(crate) fn run(task: &Papers, output: Output) -> Result<(), ProjectError> {
    let files = ["papers.html", "papers.json"].map(str::to_owned);
    let replaced = replace::check_in(&task.out, files, Holds::PAPERS, task.force)?;
    let request = PapersRequest {
        out: task.out.clone(),
        figures: task.figures.clone(),
        size: task.size,
        frames: task.frames,
        backend: task.backend,
    };
    let mut bar = Bar::new();
    let report = papers(&request, &mut |progress| {
        bar.show(&progress);
        ControlFlow::Continue(())
    });
    bar.done();
    let report = report?;
    replaced.tell();
    output.result(&report, || summary(&report, &task.out.join("papers.html").display().to_string()))?;
    let failed = report.failed();
    if failed.is_empty() {
        return Ok(());
    }
    let ids: Vec<&str> = failed.iter().map(|(id, _)| *id).collect();
    Err(ProjectError::work(format!(
        "{} of {} checks do not hold: {}",
        failed.len(),
        report.checks(),
        ids.join(", ")
    )))
}

/// The path of the page, and a line per figure and per check.
fn summary(report: &PapersReport, page: &str) -> String {
    let mut lines = vec![page.to_owned()];
    for figure in &report.figures {
        let images = figure.pictures.len();
        lines.push(format!(
            "{}: {images} images, {} tables. {}",
            figure.id,
            figure.tables.len(),
            figure.title
        ));
        lines.extend(figure.refused.iter().map(|why| format!("  could not be made: {why}")));
        lines.extend(figure.checks.iter().map(|check| {
            let mark = if check.holds { "holds" } else { "DOES NOT HOLD" };
            format!("  {mark}: {} ({})", check.claim, check.found)
        }));
    }
    lines.join("\n")
}
