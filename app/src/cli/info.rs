//! `lovelock info`.

use lovelock_studio::StudioError;

use super::args::Info;
use super::output::Output;

/// Says what a file holds.
pub(crate) fn run(task: &Info, output: Output) -> Result<(), StudioError> {
    let info = lovelock_studio::info(&task.file)?;
    output.result(&info, || info.to_string())
}
