//! The lights.

use std::f64::consts::{FRAC_PI_2, PI};

use egui::Ui;
use glam::Vec3;
use lovelock_base::settings::{Settings, Unit, Value};
use lovelock_project::Project;
use lovelock_project::error::Place;
use lovelock_render::{Light, LightKind, LightRig, MAX_LIGHTS};

use crate::window::camera_control;
use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{Number, entry, note, of_setting, setting, settings};
use crate::window::light_sphere::light_sphere;
use crate::window::panel::Panel;
use crate::window::readings::Readings;

/// How far from the head a light is put that begins to stand somewhere, metres.
const FROM_HEAD: f32 = 1.5;

/// The lights and the surroundings.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LightPanel {
    /// The light that is edited, by its place in the list.
    pub(crate) selected: usize,
    /// Whether it is unfolded; only then the handles of lights are shown.
    pub(crate) unfolded: bool,
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
        let secs = readings.frame.map_or(0.0, |frame| frame.time_secs);
        let axes = camera_control::axes(&project.camera.turned(secs));
        let head = readings.frame.map(|frame| frame.guides.world_from_head.translation.into());
        rigs(ui, project);
        ui.separator();
        list(ui, &mut project.lights, &mut self.selected, (axes, head));
        ui.separator();
        super::surroundings::ui(ui, project, readings.surroundings)
    }

    fn end_pass(&mut self, unfolded: bool) {
        self.unfolded = unfolded;
    }
}

/// The light rigs, by name.
fn rigs(ui: &mut Ui, project: &mut Project) {
    let worn = LightRig::of(&project.lights, &project.picture);
    ui.horizontal_wrapped(|ui| {
        for rig in LightRig::ALL {
            let tip = format!(
                "{} Replaces the lights, the ambient light, the exposure and the background's colours.",
                rig.description()
            );
            if ui.selectable_label(worn == Some(rig), rig.label()).hover_tooltip(tip).clicked() {
                rig.apply(&mut project.lights, &mut project.picture);
            }
        }
    });
}

/// The controls of `lights`. `selected` is the one that is edited; `axes` are the camera's right, up and back, `head` is the place of the
/// head.
fn list(ui: &mut Ui, lights: &mut Vec<Light>, selected: &mut usize, (axes, head): ([Vec3; 3], Option<Vec3>)) {
    ui.horizontal_wrapped(|ui| {
        for (i, light) in lights.iter().enumerate() {
            ui.selectable_value(selected, i, &light.name).hover_tooltip("Shows the controls of this light.");
        }
        if lights.len() < MAX_LIGHTS {
            let add = ui.button("+").accessible_name("Add a light");
            if add.hover_tooltip("Adds a light.").clicked() {
                *selected = lights.len();
                lights.push(Light { name: format!("Light {}", lights.len() + 1), ..Light::default() });
            }
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
        if light.kind != LightKind::Point {
            light_sphere(ui, &mut light.direction, axes);
        }
        ui.vertical(|ui| {
            ui.add(egui::TextEdit::singleline(&mut light.name).desired_width(100.0))
                .accessible_name("Name of this light")
                .hover_tooltip("Name of this light.");
            removed = ui.button("Remove").hover_tooltip("Removes this light.").clicked();
        });
    });
    setting(ui, "enabled", light, &default);
    let before = light.kind;
    setting(ui, "kind", light, &default);
    let head = head.unwrap_or(Vec3::new(0.0, 1.6, 0.0));
    // It goes on shining on the head as it did.
    if before == LightKind::Directional && light.stands() {
        if light.position == default.position {
            light.stand_before(head, FROM_HEAD);
        }
        light.intensity *= light.position.distance_squared(head);
        *light = light.clamped();
    } else if before != LightKind::Directional && !light.stands() {
        light.intensity /= light.position.distance_squared(head).max(light.radius * light.radius);
        *light = light.clamped();
    }
    match light.kind {
        LightKind::Directional => {
            direction_of(ui, light, &default);
            settings(ui, &["intensity", "color", "specular", "softness"], light, &default);
            settings(ui, &["shadow_samples", "angular_radius"], light, &default);
        }
        LightKind::Spot => {
            settings(ui, &["position"], light, &default);
            direction_of(ui, light, &default);
            settings(
                ui,
                &["inner_angle", "outer_angle", "radius", "shadow_samples", "intensity", "color", "specular"],
                light,
                &default,
            );
        }
        LightKind::Point => {
            settings(
                ui,
                &["position", "radius", "shadow_samples", "intensity", "color", "specular"],
                light,
                &default,
            );
        }
    }
    if removed {
        lights.remove(*selected);
        *selected = selected.saturating_sub(1);
    }
}

/// The direction of a light.
fn direction_of(ui: &mut Ui, light: &mut Light, default: &Light) {
    let info = &entry::<Light>("direction").info;
    let mut way = light.direction;
    of_setting(ui, &*light, info, Value::Vector(way.to_array()), |ui| {
        direction(ui, &mut way, default.direction);
    });
    light.direction = way;
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
