//! How the surface of the body looks.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings};
use serde::{Deserialize, Serialize};

/// Settings of the surface of bodies that have materials, as factors on what the file gives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BodyLook {
    /// Multiplies the colour of skin, linear sRGB.
    pub skin_tone: Vec3,
    /// Multiplies the roughness of skin.
    pub skin_roughness: f32,
    /// How far light spreads below skin, as a multiple of what is usual.
    pub scattering: f32,
    /// Multiplies the colour of cloth, linear sRGB.
    pub cloth_color: Vec3,
}

impl Default for BodyLook {
    fn default() -> Self {
        Self { skin_tone: Vec3::ONE, skin_roughness: 1.0, scattering: 1.0, cloth_color: Vec3::ONE }
    }
}

impl Settings for BodyLook {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::color(
            field!(Self, skin_tone),
            "Skin tone",
            "Multiplies the colour of the skin. White keeps the colour of the character.",
        ),
        Setting::number(
            field!(Self, skin_roughness),
            [0.3, 2.0],
            "Skin roughness",
            "How rough the skin is, as a multiple of the character's own: oily and shiny below 1, powdered above.",
        )
        .logarithmic(),
        Setting::number(
            field!(Self, scattering),
            [0.0, 2.0],
            "Scattering",
            "How far light spreads below the skin, which softens the edge of shade and makes it red.",
        ),
        Setting::color(
            field!(Self, cloth_color),
            "Cloth colour",
            "Multiplies the colour of clothes. White keeps the colour of the character.",
        ),
    ];
}
