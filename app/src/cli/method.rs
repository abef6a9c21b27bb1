//! `lovelock method`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use lovelock_project::error::ProjectError;
use lovelock_render::{UserMethod, new_method};
use serde::Serialize;

use super::output::Output;

#[derive(Debug, Args)]
pub(crate) struct MethodCommand {
    #[command(subcommand)]
    task: MethodTask,
}

#[derive(Debug, Subcommand)]
enum MethodTask {
    /// Writes a method to begin with, opacity maps, into a new folder: method.toml and method.wgsl.
    New(Folder),
    /// Reads the method of a folder and compiles its shader. Prints the first problem with its file and line.
    Check(Folder),
}

#[derive(Debug, Args)]
struct Folder {
    /// The folder.
    folder: PathBuf,
}

/// What was written or read.
#[derive(Debug, Serialize)]
struct MethodReport {
    id: &'static str,
    label: &'static str,
    folder: PathBuf,
    files: Vec<PathBuf>,
}

/// Writes or checks a method.
pub(crate) fn run(task: &MethodCommand, output: Output) -> Result<(), ProjectError> {
    let (MethodTask::New(Folder { folder }) | MethodTask::Check(Folder { folder })) = &task.task;
    let files = match &task.task {
        MethodTask::New(_) => new_method(folder).map_err(ProjectError::option)?,
        MethodTask::Check(_) => Vec::new(),
    };
    let method = UserMethod::load(folder).map_err(ProjectError::option)?;
    let report = MethodReport {
        id: method.id(),
        label: method.label(),
        folder: method.folder().to_owned(),
        files: files.clone(),
    };
    output.result(&report, || match &task.task {
        MethodTask::New(_) => {
            let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
            format!("{}\ncompare it: lovelock compare --method {} -o out", files.join("\n"), folder.display())
        }
        MethodTask::Check(_) => format!("{}: {} compiles", folder.display(), method.label()),
    })
}
