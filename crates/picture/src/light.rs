//! Lights.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

/// The most lights of a picture: transmittance is stored per light and strand point.
pub const MAX_LIGHTS: usize = 4;

/// A directional light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Light {
    /// What the interface calls it.
    pub name: String,
    /// Whether it is on.
    pub enabled: bool,
    /// The way the light travels, world space; any length but zero.
    pub direction: Vec3,
    /// Colour, linear sRGB, of about unit brightness.
    pub color: Vec3,
    /// Brightness.
    pub intensity: f32,
    /// Fraction of it that makes highlights: 1 for a lamp, 0 for a large soft source.
    pub specular: f32,
    /// Blur of the edges of the body's shadow in this light, metres. That of the first light that is on also softens the shadows of hair on
    /// hair and on skin.
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
                intensity: 1.2,
                specular: 0.4,
                softness: 0.012,
                enabled: true,
            },
        ]
    }

    /// The light with every value in its range and a direction of length 1.
    pub fn normalized(&self) -> Self {
        let light = self.clamped();
        Self { direction: light.direction.normalize_or(Vec3::NEG_Y), ..light }
    }

    /// The lights that are drawn: those that are enabled, at most [`MAX_LIGHTS`], normalized.
    pub fn enabled(lights: &[Self]) -> impl Iterator<Item = Self> {
        lights.iter().filter(|light| light.enabled).take(MAX_LIGHTS).map(Self::normalized)
    }
}

impl Settings for Light {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::switch(field!(Self, enabled), "Enabled", "Switches the light on."),
        Setting::direction_or_zero(
            field!(Self, direction),
            "Light direction",
            "Direction in which the light travels.",
        ),
        Setting::number(field!(Self, intensity), [0.0, 20.0], "Intensity", "Brightness of the light."),
        Setting::color(field!(Self, color), "Colour", "Colour of the light."),
        Setting::number(
            field!(Self, specular),
            [0.0, 1.0],
            "Highlights",
            "How strongly the light makes highlights: high for a lamp, low for a large soft source.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, softness),
            [0.0, 0.1],
            "Softness",
            "Blur of the edges of the body's shadow in this light. Shadows of hair, on hair and on skin, \
             are as soft in every light as in the first one that is on.",
        )
        .unit(Unit::METRES_AS_MM),
    ];

    fn reconcile(&mut self) {
        // A vector without a direction points down, as in `normalized`.
        if self.direction.try_normalize().is_none() {
            self.direction = Vec3::NEG_Y;
        }
    }
}
