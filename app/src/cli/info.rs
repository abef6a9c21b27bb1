//! `lovelock info`.

use lovelock_project::error::ProjectError;

use super::args::Info;
use super::output::Output;

/// Prints the contents of a file.
pub(crate) fn run(task: &Info, output: Output) -> Result<(), ProjectError> {
    let info = lovelock_jobs::info::info(&task.file)?;
    output.result(&info, || info.to_string())
}
