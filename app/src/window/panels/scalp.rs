//! The scalp: its display and its corrections.

use egui::Ui;
use lovelock_base::settings::Unit;
use lovelock_motion::ScalpFit;
use lovelock_project::Project;

use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{Number, note, settings};
use crate::window::overlay::scalp::ScalpTool;
use crate::window::panel::Panel;
use crate::window::pointer_tool::PointerTool;
use crate::window::readings::Readings;

/// The scalp of the body.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ScalpPanel {
    pub(crate) tool: ScalpTool,
    /// Whether it is unfolded; only then the scalp can be painted.
    pub(crate) unfolded: bool,
}

impl Panel for ScalpPanel {
    fn title(&self) -> &'static str {
        "Scalp"
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        controls(ui, &mut project.body.scalp, &mut self.tool, readings)
    }

    fn end_pass(&mut self, unfolded: bool) {
        self.unfolded = unfolded;
    }
}

/// The controls of the scalp of a body.
fn controls(
    ui: &mut Ui,
    fit: &mut ScalpFit,
    tool: &mut ScalpTool,
    readings: &Readings<'_>,
) -> Option<Command> {
    let is_used = readings.tool == PointerTool::Scalp;
    let mut paints = is_used;
    if !readings.has_skull {
        note(ui, "This body has no surface on which hair can grow.");
    }
    ui.horizontal_wrapped(|ui| {
        ui.checkbox(&mut tool.shown, "Show scalp").hover_tooltip(
            "Shows where hair grows. Drag the handles of its outline in the image; double-click one to restore it.",
        );
        paints &= tool.shown;
        let paint = ui
            .checkbox(&mut paints, "Paint scalp")
            .hover_tooltip("Drag over the head to add hair, Ctrl+drag to remove it.");
        if paint.changed() {
            tool.shown |= paints;
        }
    });
    if paints {
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
    settings(ui, &["area"], fit, &default);
    let was_by_hand = fit.by_hand;
    settings(ui, &["by_hand"], fit, &default);
    if fit.by_hand && !was_by_hand {
        begin_at_skull(fit, readings);
    }
    if fit.by_hand {
        settings(ui, &["middle", "skull_height"], fit, &default);
    }
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
    (paints != is_used).then_some(Command::Use(PointerTool::Scalp))
}

/// Begins to place the scalp by hand at the skull that was found.
fn begin_at_skull(fit: &mut ScalpFit, readings: &Readings<'_>) {
    let Some((scene, skull)) = readings.frame.and_then(|frame| Some((&frame.scene, frame.scene.skull?)))
    else {
        return;
    };
    let skeleton = &scene.body.skeleton;
    if skeleton.joints.get(scene.body.head_joint).is_some() {
        fit.middle = skeleton.rest_position(scene.body.head_joint) + skull.middle;
        fit.skull_height = 2.0 * skull.half.y;
    }
}
