//! What hair collides with.

use egui::Ui;
use lovelock_studio::motion::{ColliderEdit, ColliderEdits, FieldEdit};

use crate::window::control::{Number, choice, note, row, section, toggle};

/// What is shown of the colliders over the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shown {
    /// Whether they are seen.
    pub(crate) on: bool,
    /// The one that is edited.
    pub(crate) selected: usize,
}

/// The controls of `edits`. `names` are the colliders that were fitted to the body.
pub(crate) fn ui(ui: &mut Ui, edits: &mut ColliderEdits, names: &[&str], shown: &mut Shown) {
    toggle(
        ui,
        "Show",
        "Draws what hair collides with over the picture. Click a shape there to choose it.",
        &mut shown.on,
        false,
    );
    if names.is_empty() {
        note(ui, "Nothing was fitted to this body.");
        return;
    }
    shown.selected = shown.selected.min(names.len() - 1);
    let options: Vec<(usize, &str)> = names.iter().copied().enumerate().collect();
    let before = shown.selected;
    choice(
        ui,
        "Collider",
        "The shape that is edited, named after its joint.",
        &mut shown.selected,
        before,
        &options,
    );
    let name = names[shown.selected];
    let default = ColliderEdit::default();
    let mut edit = edits.shapes.get(name).copied().unwrap_or_default();
    toggle(ui, "On", "Whether hair meets this shape at all.", &mut edit.enabled, default.enabled);
    Number::new("Size", 0.2..=3.0, "How large its radii are, of those that were fitted.").percent().show(
        ui,
        &mut edit.scale,
        default.scale,
    );
    let ways = [
        ("Sideways", "Moves the shape toward the body's left, as the body rests."),
        ("Upward", "Moves the shape up, as the body rests."),
        ("Forward", "Moves the shape to the front, as the body rests."),
    ];
    for ((label, tip), offset) in ways.into_iter().zip(&mut edit.offset) {
        Number::new(label, -0.5..=0.5, tip).centimetres().show(ui, offset, 0.0);
    }
    if edit == default {
        edits.shapes.remove(name);
    } else {
        edits.shapes.insert(name.to_owned(), edit);
    }
    section(ui, "Head and shoulders", true, |ui| {
        let default = FieldEdit::default();
        toggle(
            ui,
            "Skin",
            "Whether hair meets the skin of head, neck and shoulders itself, and not the round shapes that stand for them.",
            &mut edits.field.enabled,
            default.enabled,
        );
        Number::new("Lift", -0.02..=0.02, "How far outside the skin hair is stopped.").millimetres().show(
            ui,
            &mut edits.field.lift,
            default.lift,
        );
    });
    if *edits == ColliderEdits::default() {
        return;
    }
    row(
        ui,
        "Colliders",
        "Restores every shape as it was fitted.",
        false,
        edits,
        ColliderEdits::default(),
        |ui, edits| {
            let response = ui.button("Restore all");
            if response.clicked() {
                *edits = ColliderEdits::default();
            }
            response
        },
    );
}
