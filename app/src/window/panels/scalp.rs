//! The scalp: its display and its corrections.

use egui::Ui;
use lovelock_base::settings::Unit;
use lovelock_motion::ScalpFit;

use crate::window::control::HoverTooltip;
use crate::window::control::{Number, note, settings};
use crate::window::overlay::scalp::ScalpTool;
use crate::window::pointer_tool::PointerTool;

/// The controls of the scalp of a body. `found` is whether the body has one.
pub(crate) fn ui(
    ui: &mut Ui,
    fit: &mut ScalpFit,
    (tool, pointer): (&mut ScalpTool, &mut PointerTool),
    found: bool,
) {
    if !found {
        note(ui, "This body has no surface on which hair can grow.");
    }
    ui.horizontal_wrapped(|ui| {
        ui.checkbox(&mut tool.shown, "Show scalp").hover_tooltip(
            "Shows where hair grows. Drag the handles of its outline in the image; double-click one to restore it.",
        );
        if !tool.shown {
            pointer.set(PointerTool::Scalp, false);
        }
        let mut paints = *pointer == PointerTool::Scalp;
        let paint = ui
            .checkbox(&mut paints, "Paint scalp")
            .hover_tooltip("Drag over the head to add hair, Ctrl+drag to remove it.");
        if paint.changed() {
            pointer.set(PointerTool::Scalp, paints);
            tool.shown |= paints;
        }
    });
    if *pointer == PointerTool::Scalp {
        Number::new(
            "Brush",
            0.03..=0.8,
            Unit::RADIANS,
            "Size of the brush, seen from the middle of the head.",
        )
        .show(ui, &mut tool.brush, ScalpTool::default().brush);
        ui.checkbox(&mut tool.mirrored, "Both sides")
            .hover_tooltip("Paints the same on the other side of the head.");
    }
    let default = ScalpFit::default();
    settings(ui, &["forward", "up", "nod", "width", "size"], fit, &default);
    settings(
        ui,
        &[
            "raise.front",
            "raise.corner",
            "raise.temple",
            "raise.before_ear",
            "raise.above_ear",
            "raise.behind_ear",
            "raise.nape",
        ],
        fit,
        &default,
    );
    ui.horizontal_wrapped(|ui| {
        let painted = ui.add_enabled(fit.is_painted(), egui::Button::new("Clear paint"));
        let painted = painted.disabled_hover_tooltip("Nothing is painted on the scalp.");
        if painted.hover_tooltip("Removes what was painted on the scalp.").clicked() {
            fit.added = default.added.clone();
            fit.removed = default.removed.clone();
        }
        let reset = ui.add_enabled(!fit.is_automatic(), egui::Button::new("Fit again"));
        let reset = reset.disabled_hover_tooltip("The scalp is unchanged.");
        if reset.hover_tooltip("Restores the detected scalp.").clicked() {
            *fit = default.clone();
        }
    });
}
