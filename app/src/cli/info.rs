//! `lovelock info`.

use lovelock_project::error::StudioError;

use super::args::Info;
use super::output::Output;

/// Says what a file holds.
pub(crate) fn run(task: &Info, output: Output) -> Result<(), StudioError> {
    let info = lovelock_jobs::info::info(&task.file)?;
    output.result(&info, || info.to_string())
}
