//! The surface of the body: skin and cloth.

use egui::Ui;
use lovelock_project::Project;
use lovelock_render::BodyLook;

use crate::window::command::Command;
use crate::window::control::settings;
use crate::window::panel::Panel;
use crate::window::readings::Readings;

const SKIN: [&str; 3] = ["skin_tone", "skin_roughness", "scattering"];

const CLOTH: [&str; 1] = ["cloth_color"];

/// The surface of the body.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BodyLookPanel;

impl Panel for BodyLookPanel {
    fn title(&self) -> &'static str {
        "Body look"
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, _: &Readings<'_>) -> Option<Command> {
        let (look, default) = (&mut project.picture.body_look, BodyLook::default());
        settings(ui, &SKIN, look, &default);
        settings(ui, &CLOTH, look, &default);
        None
    }
}
