//! The lights.

use egui::Ui;
use glam::Vec3;
use lovelock_render::{Light, MAX_LIGHTS};

use crate::window::control::{Number, color, note, toggle};
use crate::window::light_sphere::light_sphere;

/// The controls of `lights`. `selected` is the one that is edited; `axes` are the camera's right, up and back.
pub(crate) fn ui(ui: &mut Ui, lights: &mut Vec<Light>, selected: &mut usize, axes: [Vec3; 3]) {
    ui.horizontal_wrapped(|ui| {
        for (i, light) in lights.iter().enumerate() {
            ui.selectable_value(selected, i, &light.name).on_hover_text("Shows the controls of this light.");
        }
        if lights.len() < MAX_LIGHTS && ui.button("+").on_hover_text("Adds a light.").clicked() {
            *selected = lights.len();
            lights.push(Light { name: format!("Light {}", lights.len() + 1), ..Light::default() });
        }
    });
    *selected = (*selected).min(lights.len().saturating_sub(1));
    let standard = Light::default_rig();
    let default = standard.get(*selected).cloned().unwrap_or_default();
    let Some(light) = lights.get_mut(*selected) else {
        note(ui, "No light: only what comes from everywhere.");
        return;
    };
    ui.horizontal(|ui| {
        light_sphere(ui, &mut light.direction, axes);
        ui.vertical(|ui| {
            ui.add(egui::TextEdit::singleline(&mut light.name).desired_width(100.0))
                .on_hover_text("What this light is called.");
            let mut remove = false;
            if ui.button("Remove").on_hover_text("Removes this light.").clicked() {
                remove = true;
            }
            if remove {
                ui.data_mut(|data| data.insert_temp(egui::Id::unique("remove light"), true));
            }
        });
    });
    toggle(ui, "On", "Whether this light shines.", &mut light.enabled, default.enabled);
    let [mut azimuth, mut elevation] = angles(light.direction);
    let [default_azimuth, default_elevation] = angles(default.direction);
    let before = [azimuth, elevation];
    Number::new(
        "Azimuth",
        -std::f32::consts::PI..=std::f32::consts::PI,
        "Where the light comes from about the vertical: 0 is the front, 90 the dancer's left.",
    )
    .degrees()
    .show(ui, &mut azimuth, default_azimuth);
    Number::new(
        "Elevation",
        -std::f32::consts::FRAC_PI_2..=std::f32::consts::FRAC_PI_2,
        "How high above the horizon the light stands.",
    )
    .degrees()
    .show(ui, &mut elevation, default_elevation);
    if before != [azimuth, elevation] {
        // Back at the default is back at its very bytes: sines would leave a trace of the way.
        let near = |angle: f32, default: f32| (angle - default).abs() < 1e-5;
        let restored = near(azimuth, default_azimuth) && near(elevation, default_elevation);
        light.direction = if restored { default.direction } else { direction(azimuth, elevation) };
    }
    Number::new("Intensity", 0.0..=20.0, "How bright this light is.").show(
        ui,
        &mut light.intensity,
        default.intensity,
    );
    let mut rgb = light.color.to_array();
    color(ui, "Colour", "Colour of this light.", &mut rgb, default.color.to_array());
    light.color = Vec3::from_array(rgb);
    Number::new(
        "Highlights",
        0.0..=1.0,
        "How much this light makes highlights: a lamp does, a large soft source does not.",
    )
    .percent()
    .show(ui, &mut light.specular, default.specular);
    Number::new("Softness", 0.0..=0.1, "Blur of the body's shadow in this light.").millimetres().show(
        ui,
        &mut light.softness,
        default.softness,
    );
    if ui.data_mut(|data| data.remove_temp::<bool>(egui::Id::unique("remove light"))).is_some() {
        lights.remove(*selected);
        *selected = selected.saturating_sub(1);
    }
}

/// Azimuth and elevation of where a light that travels along `direction` comes from, radians.
fn angles(direction: Vec3) -> [f32; 2] {
    let from = -direction.normalize_or(Vec3::NEG_Y);
    [from.x.atan2(from.z), from.y.clamp(-1.0, 1.0).asin()]
}

/// The way a light travels that comes from `azimuth` and `elevation`.
fn direction(azimuth: f32, elevation: f32) -> Vec3 {
    -Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_direction_are_inverse() {
        for (azimuth, elevation) in [(0.0, 0.0), (1.2, 0.7), (-2.9, -0.4), (0.3, 1.5)] {
            let [a, e] = angles(direction(azimuth, elevation));
            assert!(
                (a - azimuth).abs() < 1e-4 && (e - elevation).abs() < 1e-4,
                "{azimuth} {elevation}: {a} {e}"
            );
        }
    }
}
