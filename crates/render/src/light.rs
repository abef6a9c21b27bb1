//! Lights.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// The most lights of a picture: transmittance is stored per light and strand point.
pub const MAX_LIGHTS: usize = 4;

/// A directional light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Light {
    /// What the interface calls it.
    pub name: String,
    /// Whether it shines.
    pub enabled: bool,
    /// The way the light travels, world space; any length but zero.
    pub direction: Vec3,
    /// Colour, linear sRGB, of about unit brightness.
    pub color: Vec3,
    /// Brightness: 0 to 20.
    pub intensity: f32,
    /// How much of it makes highlights: 1 for a lamp, 0 for a large soft source.
    pub specular: f32,
    /// How soft the body's shadow edges are in this light, metres of blur: 0 to 0.1.
    pub softness: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            name: "Key".to_owned(),
            enabled: true,
            direction: Vec3::new(-0.5, -0.7, -0.5),
            color: Vec3::ONE,
            intensity: 3.0,
            specular: 1.0,
            softness: 0.01,
        }
    }
}

impl Light {
    /// The three lights of the default scene: a soft warm key from above and the side, a cool weak fill from
    /// the other side, and a rim light from behind that shows the silhouette.
    pub fn default_rig() -> Vec<Self> {
        vec![
            Self {
                name: "Key".to_owned(),
                direction: Vec3::new(-0.62, -0.62, -0.48),
                color: Vec3::new(1.0, 0.94, 0.86),
                intensity: 3.2,
                specular: 1.0,
                softness: 0.012,
                enabled: true,
            },
            Self {
                name: "Rim".to_owned(),
                direction: Vec3::new(0.55, -0.45, 0.70),
                color: Vec3::new(0.86, 0.93, 1.0),
                intensity: 2.2,
                specular: 0.8,
                softness: 0.012,
                enabled: true,
            },
            Self {
                name: "Fill".to_owned(),
                direction: Vec3::new(0.70, -0.35, -0.62),
                color: Vec3::new(0.72, 0.82, 1.0),
                intensity: 0.7,
                specular: 0.15,
                softness: 0.05,
                enabled: true,
            },
        ]
    }

    /// A copy whose every value is finite and in range; a zero or non-finite direction becomes straight down.
    pub fn clamped(&self) -> Self {
        let finite = |v: f32, low: f32, high: f32, default: f32| {
            if v.is_finite() { v.clamp(low, high) } else { default }
        };
        let direction = if self.direction.is_finite() { self.direction } else { Vec3::NEG_Y };
        Self {
            name: self.name.clone(),
            enabled: self.enabled,
            direction: direction.normalize_or(Vec3::NEG_Y),
            color: Vec3::from_array(self.color.to_array().map(|c| finite(c, 0.0, 4.0, 1.0))),
            intensity: finite(self.intensity, 0.0, 20.0, 1.0),
            specular: finite(self.specular, 0.0, 1.0, 1.0),
            softness: finite(self.softness, 0.0, 0.1, 0.01),
        }
    }
}
