//! What hair collides with.

use egui::Ui;
use lovelock_motion::{ColliderEdit, ColliderEdits, FieldEdit};
use lovelock_project::Project;

use crate::window::command::Command;
use crate::window::control::{choice, entry, note, restore_all, section, setting, settings, toggle, unless};
use crate::window::panel::Panel;
use crate::window::readings::Readings;

/// What hair collides with, and how it is shown over the image.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CollidersPanel {
    /// Whether they are visible.
    pub(crate) on: bool,
    /// The one that is edited.
    pub(crate) selected: usize,
}

impl Panel for CollidersPanel {
    fn title(&self) -> &'static str {
        "Colliders"
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        controls(ui, &mut project.body.colliders, readings, self);
        None
    }
}

/// The controls of `edits`, of the colliders that were fitted to the body.
fn controls(ui: &mut Ui, edits: &mut ColliderEdits, readings: &Readings<'_>, shown: &mut CollidersPanel) {
    let fitted = &readings.colliders;
    toggle(
        ui,
        "Show",
        "Shows the colliders over the image. Click a shape there to select it, drag its middle to move it, and drag its rim to scale \
         it.",
        &mut shown.on,
        false,
    );
    if fitted.is_empty() {
        note(ui, "No colliders were fitted to this body.");
        return;
    }
    shown.selected = shown.selected.min(fitted.len() - 1);
    let options: Vec<(usize, &str)> = fitted.iter().copied().enumerate().collect();
    let before = shown.selected;
    choice(
        ui,
        "Collider",
        "The shape to edit, named after its joint.",
        &mut shown.selected,
        before,
        &options,
    );
    let (name, spared) = (fitted[shown.selected], (readings.is_replaced)(edits, shown.selected));
    let default = ColliderEdit::default();
    let mut edit = edits.of(name);
    if spared {
        let why_not = "Hair collides with the skin here and not with this shape. To use the shape, change its size or its position, or \
                       switch off Skin below.";
        let info = &entry::<ColliderEdit>("enabled").info;
        unless(ui, Some(why_not), |ui| toggle(ui, info.label, &info.tooltip(), &mut false, false));
    } else {
        setting(ui, "enabled", &mut edit, &default);
    }
    settings(ui, &["scale", "offset"], &mut edit, &default);
    edits.set(name, edit);
    section(ui, "Head and shoulders", true, |ui| {
        settings(ui, &["enabled", "lift"], &mut edits.field, &FieldEdit::default());
    });
    if *edits == ColliderEdits::default() {
        return;
    }
    restore_all(
        ui,
        "Colliders",
        "Restores every shape to its fitted size and position.",
        edits,
        &ColliderEdits::default(),
    );
}
