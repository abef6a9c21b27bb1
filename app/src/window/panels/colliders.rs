//! What hair collides with.

use egui::Ui;
use lovelock_motion::{ColliderEdit, ColliderEdits, FieldEdit};

use crate::window::control::{Number, choice, note, row, section, toggle, unless};

/// A collider that was fitted to the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fitted<'a> {
    /// Named after its joint.
    pub(crate) name: &'a str,
    /// Whether the skin of head and shoulders stands for it.
    pub(crate) spared: bool,
}

/// What is shown of the colliders over the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shown {
    /// Whether they are seen.
    pub(crate) on: bool,
    /// The one that is edited.
    pub(crate) selected: usize,
}

/// The controls of `edits`, of the colliders that were `fitted` to the body.
pub(crate) fn ui(ui: &mut Ui, edits: &mut ColliderEdits, fitted: &[Fitted<'_>], shown: &mut Shown) {
    toggle(
        ui,
        "Show",
        "Draws what hair collides with over the picture. Click a shape there to choose it; drag its middle to move it, and its rim to \
         make it larger or smaller.",
        &mut shown.on,
        false,
    );
    if fitted.is_empty() {
        note(ui, "Nothing was fitted to this body.");
        return;
    }
    shown.selected = shown.selected.min(fitted.len() - 1);
    let options: Vec<(usize, &str)> = fitted.iter().map(|of| of.name).enumerate().collect();
    let before = shown.selected;
    choice(
        ui,
        "Collider",
        "The shape that is edited, named after its joint.",
        &mut shown.selected,
        before,
        &options,
    );
    let Fitted { name, spared } = fitted[shown.selected];
    let default = ColliderEdit::default();
    let mut edit = edits.of(name);
    let tip = "Whether hair meets this shape at all.";
    if spared {
        let why_not = "Hair meets the skin here, and not this shape. Change its size or its place, or switch off Skin below, and hair \
                       meets it.";
        unless(ui, Some(why_not), |ui| toggle(ui, "On", tip, &mut false, false));
    } else {
        toggle(ui, "On", tip, &mut edit.enabled, default.enabled);
    }
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
    edits.set(name, edit);
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
