//! What hair collides with.

use egui::Ui;
use lovelock_motion::{ColliderEdit, ColliderEdits, FieldEdit};

use crate::window::control::{choice, entry, note, restore_all, section, setting, settings, toggle, unless};

/// A collider that was fitted to the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fitted<'a> {
    /// Named after its joint.
    pub(crate) name: &'a str,
    /// Whether hair collides with the skin of head and shoulders in its place.
    pub(crate) spared: bool,
}

/// How the colliders are shown over the image.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shown {
    /// Whether they are visible.
    pub(crate) on: bool,
    /// The one that is edited.
    pub(crate) selected: usize,
}

/// The controls of `edits`, of the colliders that were `fitted` to the body.
pub(crate) fn ui(ui: &mut Ui, edits: &mut ColliderEdits, fitted: &[Fitted<'_>], shown: &mut Shown) {
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
    let options: Vec<(usize, &str)> = fitted.iter().map(|of| of.name).enumerate().collect();
    let before = shown.selected;
    choice(
        ui,
        "Collider",
        "The shape to edit, named after its joint.",
        &mut shown.selected,
        before,
        &options,
    );
    let Fitted { name, spared } = fitted[shown.selected];
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
