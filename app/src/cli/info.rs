//! `lovelock info`.

use lovelock_groom::ImportSettings;
use lovelock_project::error::ProjectError;

use super::args::Info;
use super::output::Output;

/// Prints the contents of a file.
pub(crate) fn run(task: &Info, output: Output) -> Result<(), ProjectError> {
    let import = ImportSettings { unit: task.unit, up: task.up, ..ImportSettings::default() };
    let info = lovelock_jobs::info::info_as(&task.file, &import)?;
    output.result(&info, || info.to_string())
}
