//! The lights.

use std::f64::consts::{FRAC_PI_2, PI};

use egui::Ui;
use glam::Vec3;
use lovelock_base::settings::{Unit, Value};
use lovelock_project::Project;
use lovelock_project::error::Place;
use lovelock_render::{Light, MAX_LIGHTS};

use crate::window::camera_control;
use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{Number, entry, note, of_setting, setting, settings};
use crate::window::light_sphere::light_sphere;
use crate::window::panel::Panel;
use crate::window::readings::Readings;

/// The lights and the surroundings.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LightPanel {
    /// The light that is edited, by its place in the list.
    pub(crate) selected: usize,
}

impl Panel for LightPanel {
    fn title(&self) -> &'static str {
        "Light"
    }

    fn opens(&self, _project: &Project, _readings: &Readings<'_>) -> bool {
        true
    }

    fn places(&self) -> &'static [Place] {
        &[Place::Surroundings]
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        let axes = camera_control::axes(&project.camera);
        list(ui, &mut project.lights, &mut self.selected, axes);
        ui.separator();
        super::surroundings::ui(ui, project, readings.surroundings)
    }
}

/// The controls of `lights`. `selected` is the one that is edited; `axes` are the camera's right, up and back.
fn list(ui: &mut Ui, lights: &mut Vec<Light>, selected: &mut usize, axes: [Vec3; 3]) {
    ui.horizontal_wrapped(|ui| {
        for (i, light) in lights.iter().enumerate() {
            ui.selectable_value(selected, i, &light.name).hover_tooltip("Shows the controls of this light.");
        }
        if lights.len() < MAX_LIGHTS && ui.button("+").hover_tooltip("Adds a light.").clicked() {
            *selected = lights.len();
            lights.push(Light { name: format!("Light {}", lights.len() + 1), ..Light::default() });
        }
    });
    *selected = (*selected).min(lights.len().saturating_sub(1));
    let default = Light::default_rig().get(*selected).cloned().unwrap_or_default();
    let Some(light) = lights.get_mut(*selected) else {
        note(ui, "No light: only the ambient light remains.");
        return;
    };
    let mut removed = false;
    ui.horizontal(|ui| {
        light_sphere(ui, &mut light.direction, axes);
        ui.vertical(|ui| {
            ui.add(egui::TextEdit::singleline(&mut light.name).desired_width(100.0))
                .hover_tooltip("Name of this light.");
            removed = ui.button("Remove").hover_tooltip("Removes this light.").clicked();
        });
    });
    setting(ui, "enabled", light, &default);
    let info = &entry::<Light>("direction").info;
    let mut way = light.direction;
    of_setting(ui, &*light, info, Value::Vector(way.to_array()), |ui| {
        direction(ui, &mut way, default.direction);
    });
    light.direction = way;
    settings(ui, &["intensity", "color", "specular", "softness"], light, &default);
    if removed {
        lights.remove(*selected);
        *selected = selected.saturating_sub(1);
    }
}

/// The direction of a light as the two angles of the place that it comes from.
fn direction(ui: &mut Ui, direction: &mut Vec3, default: Vec3) {
    let [mut azimuth, mut elevation] = angles(*direction);
    let [default_azimuth, default_elevation] = angles(default);
    let before = [azimuth, elevation];
    let tip = "Angle about the vertical from which the light comes: 0 is the front, 90 the dancer's left.";
    Number::new("Azimuth", -PI..=PI, Unit::RADIANS, tip).show(ui, &mut azimuth, default_azimuth);
    let tip = "Height of the light above the horizon.";
    Number::new("Elevation", -FRAC_PI_2..=FRAC_PI_2, Unit::RADIANS, tip).show(
        ui,
        &mut elevation,
        default_elevation,
    );
    if before != [azimuth, elevation] {
        // A restored default has exactly its own bytes: sines would leave a rounding error.
        let near = |angle: f32, default: f32| (angle - default).abs() < 1e-5;
        let restored = near(azimuth, default_azimuth) && near(elevation, default_elevation);
        *direction = if restored { default } else { travel(azimuth, elevation) };
    }
}

/// Azimuth and elevation of the place from which a light comes that travels along `direction`, radians.
fn angles(direction: Vec3) -> [f32; 2] {
    let from = -direction.normalize_or(Vec3::NEG_Y);
    [from.x.atan2(from.z), from.y.clamp(-1.0, 1.0).asin()]
}

/// The direction in which a light travels that comes from `azimuth` and `elevation`.
fn travel(azimuth: f32, elevation: f32) -> Vec3 {
    -Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_direction_are_inverse() {
        for (azimuth, elevation) in [(0.0, 0.0), (1.2, 0.7), (-2.9, -0.4), (0.3, 1.5)] {
            let [a, e] = angles(travel(azimuth, elevation));
            assert!(
                (a - azimuth).abs() < 1e-4 && (e - elevation).abs() < 1e-4,
                "{azimuth} {elevation}: {a} {e}"
            );
        }
    }
}
