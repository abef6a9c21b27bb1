//! The controls of a morph, which stand above the styles while there is one.

use egui::{Frame, Ui};
use lovelock_project::Project;
use lovelock_project::project::HairMorph;

use crate::window::control::HoverTooltip;
use crate::window::control::setting;

/// The slider from the project's own style to the second one, and what ends the morph.
pub(super) fn ui(ui: &mut Ui, project: &mut Project) {
    let Some(to) = &project.hair.morph.to else { return };
    let name = if to.name.is_empty() { "the second style".to_owned() } else { to.name.clone() };
    let mut ends = None;
    Frame::group(ui.style()).show(ui, |ui| {
        ui.label(format!("Turns into {name}"));
        setting(ui, "amount", &mut project.hair.morph, &HairMorph::default());
        ui.horizontal(|ui| {
            let take = ui.button(format!("Become {name}"));
            if take
                .hover_tooltip("Ends the morph. The second style becomes the style of the project.")
                .clicked()
            {
                ends = Some(true);
            }
            let end = ui.button("End morph");
            if end.hover_tooltip("Ends the morph and keeps the project's own style.").clicked() {
                ends = Some(false);
            }
        });
    });
    match ends {
        Some(true) => project.take_morph(),
        Some(false) => project.end_morph(),
        None => {}
    }
}
