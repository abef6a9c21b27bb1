//! `lovelock settings`.

use lovelock_project::error::ProjectError;
use lovelock_project::project::{settings_json, settings_of, settings_page, settings_table, settings_text};

use super::args::SettingsTask;
use super::output::Output;

/// Prints every setting, or those of a section.
pub(crate) fn run(task: &SettingsTask, output: Output) -> Result<(), ProjectError> {
    let section = task.section.as_deref().unwrap_or_default();
    let settings = settings_of(section);
    if settings.is_empty() {
        let message = format!(
            "{section}: there are no such settings; must be the start of a name, such as simulation.wind"
        );
        return Err(ProjectError::option(message));
    }
    output.result(&settings_json(&settings), || match (task.markdown, section) {
        (true, "") => settings_page(),
        (true, section) => settings_table(section),
        (false, _) => settings_text(&settings),
    })
}
