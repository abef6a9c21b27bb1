//! `lovelock satf`.

use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::Once;

use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use lovelock_jobs::satf::build_satf;
use lovelock_project::error::ProjectError;

use super::output::Output;
use super::replace::{self, Holds};

/// Resolution of the progress bar.
const TICKS: f32 = 1000.0;

#[derive(Debug, Args)]
pub(crate) struct Satf {
    #[command(subcommand)]
    pub(crate) task: SatfTask,
}

#[derive(Debug, Subcommand)]
pub(crate) enum SatfTask {
    /// Writes the database to a file, with the same bytes on every run. The program builds its own at first use, in the user's cache
    /// folder.
    Build(SatfBuild),
}

#[derive(Debug, Args)]
pub(crate) struct SatfBuild {
    /// The file.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Replace the file even if it is not a database.
    #[arg(long)]
    pub(crate) force: bool,
}

/// Makes the database of hair clusters.
pub(crate) fn run(task: &Satf, output: Output) -> Result<(), ProjectError> {
    let SatfTask::Build(task) = &task.task;
    let replaced = replace::check(&task.out, Holds::DATABASE, task.force)?;
    let bar = std::io::stderr().is_terminal().then(|| {
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent} %")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        ProgressBar::new(TICKS as u64).with_style(style).with_message("building the database")
    });
    // An output that cannot be written is refused before any work.
    let begins = Once::new();
    let report = build_satf(&task.out, &|done| match &bar {
        Some(bar) => bar.set_position((TICKS * done) as u64),
        None => begins.call_once(|| eprintln!("building the database of hair clusters")),
    });
    if let Some(bar) = &bar {
        bar.finish_and_clear();
    }
    let report = report?;
    replaced.tell();
    output.result(&report, || {
        let megabytes = report.bytes as f64 / 1e6;
        format!("{}: {megabytes:.2} MB in {:.2} s, checksum {}", report.file, report.seconds, report.checksum)
    })
}
