//! What every panel beside the image has.

use egui::Ui;
use lovelock_project::Project;
use lovelock_project::error::Place;

use super::command::Command;
use super::readings::Readings;

/// A section of a column beside the image: its controls edit the project, and it owns what is selected and unfolded in it.
pub(crate) trait Panel {
    /// The name in the header.
    fn title(&self) -> &'static str;

    /// Whether it is unfolded until the user folds it.
    fn opens(&self, _project: &Project, _readings: &Readings<'_>) -> bool {
        false
    }

    /// Whether it is listed at present.
    fn is_shown(&self, _project: &Project) -> bool {
        true
    }

    /// Whether it can be used while a take plays.
    fn edits_takes(&self, _project: &Project) -> bool {
        false
    }

    /// The parts of the project whose problems its header marks.
    fn places(&self) -> &'static [Place] {
        &[]
    }

    /// The problems that its header marks.
    fn problems(&self, readings: &Readings<'_>) -> Vec<String> {
        let here = readings.problems.iter().filter(|problem| self.places().contains(&problem.place));
        here.map(|problem| problem.message.clone()).collect()
    }

    /// Shows the controls. Returns what they ask the window to do.
    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command>;

    /// Called after each pass in which it is listed, with whether its controls were shown.
    fn end_pass(&mut self, _unfolded: bool) {}
}
