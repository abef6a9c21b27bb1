//! The camera: its target, its lens and the turntable.

use egui::Ui;
use lovelock_project::Project;
use lovelock_project::project::{CameraMode, CameraSection, FocusOn, LensSettings};

use crate::window::command::Command;
use crate::window::control::{section, setting, settings};
use crate::window::panel::Panel;
use crate::window::readings::Readings;

/// The camera.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CameraPanel;

impl Panel for CameraPanel {
    fn title(&self) -> &'static str {
        "Camera"
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, _readings: &Readings<'_>) -> Option<Command> {
        let (camera, default) = (&mut project.camera, CameraSection::default());
        setting(ui, "fov_y", camera, &default);
        setting(ui, "mode", camera, &default);
        match camera.mode {
            CameraMode::Follow => settings(ui, &["follow_secs"], camera, &default),
            CameraMode::Fixed => settings(ui, &["fixed_target"], camera, &default),
        }
        turntable(ui, camera);
        section(ui, "Lens", true, |ui| lens(ui, &mut project.camera));
        None
    }
}

/// The controls of depth of field.
fn lens(ui: &mut Ui, camera: &mut CameraSection) {
    let default = LensSettings::default();
    let lens = &mut camera.lens;
    setting(ui, "enabled", lens, &default);
    if !lens.enabled {
        return;
    }
    settings(ui, &["f_number", "focus"], lens, &default);
    if lens.focus == FocusOn::Distance {
        setting(ui, "distance", lens, &default);
    }
    setting(ui, "samples", lens, &default);
}

/// The controls of the turntable.
pub(super) fn turntable(ui: &mut Ui, camera: &mut CameraSection) {
    let default = CameraSection::default();
    setting(ui, "turntable", camera, &default);
    if camera.turntable {
        setting(ui, "turn_secs", camera, &default);
    }
}
