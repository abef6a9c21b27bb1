//! The face: a weight for each expression, otherwise for each morph target of the body.

use egui::{TextEdit, Ui};
use lovelock_base::settings::{Kind, Unit};
use lovelock_motion::{FaceWeight, FaceWeights};
use lovelock_project::Project;

use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{Number, entry, note, restore_all};
use crate::window::panel::Panel;
use crate::window::readings::Readings;
use crate::window::search::fit;

/// From so many names on, they can be searched.
const SEARCHED: usize = 12;
/// The most names that are listed; the search finds the others.
const LISTED: usize = 60;

/// The weights of the face, and what was typed to search them.
#[derive(Clone, Debug, Default)]
pub(crate) struct FacePanel {
    typed: String,
}

impl Panel for FacePanel {
    fn title(&self) -> &'static str {
        "Face"
    }

    fn edits_takes(&self, project: &Project) -> bool {
        project.plays_curves()
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        controls(ui, &mut project.body.face, &readings.body.face, &mut self.typed);
        None
    }
}

/// The controls of `weights`, of the names that the body has.
fn controls(ui: &mut Ui, weights: &mut FaceWeights, names: &[String], typed: &mut String) {
    if names.is_empty() {
        note(ui, "This body has neither expressions nor morph targets.");
    }
    if names.len() >= SEARCHED {
        let field =
            TextEdit::singleline(typed).char_limit(80).hint_text("Search").desired_width(f32::INFINITY);
        ui.add(field).hover_tooltip("Lists only what has this in its name.");
    } else {
        typed.clear();
    }
    let found: Vec<&String> = names.iter().filter(|name| fit(typed, name, &[]).is_some()).collect();
    let info = &entry::<FaceWeight>("weight").info;
    let range = match info.kind {
        Kind::Number(range) => range.soft[0]..=range.soft[1],
        _ => 0.0..=1.0,
    };
    for name in found.iter().take(LISTED) {
        let mut weight = weights.of(name);
        Number::new((*name).clone(), range.clone(), Unit::FRACTION, info.text).show(ui, &mut weight, 0.0);
        weights.set(name, weight);
    }
    if found.len() > LISTED {
        note(ui, format!("{} more: search for them by name.", found.len() - LISTED));
    }
    if found.is_empty() && !names.is_empty() {
        note(ui, "Nothing has this in its name.");
    }
    if !weights.0.is_empty() {
        restore_all(ui, "Face", "Sets every weight to 0.", weights, &FaceWeights::default());
    }
}
