//! Colour and width of hair.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use lovelock_base::numbers::within;

/// What hair is made of and how thick it is: everything about its appearance that no light changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct HairLook {
    /// Concentration of eumelanin, which makes hair brown and black: 0 to 8.
    pub eumelanin: f32,
    /// Concentration of pheomelanin, which makes hair red: 0 to 8.
    pub pheomelanin: f32,
    /// How much the melanin of strands differs from each other, as a fraction: 0 to 1.
    pub variation: f32,
    /// How much lighter the tips are than the roots, as a fraction of the melanin: 0 to 1.
    pub tip_lightening: f32,
    /// Diameter of one real hair, metres: 17e-6 to 100e-6.
    pub diameter: f32,
    /// Number of real hairs that all drawn strands together stand for: 1 to 10 million.
    pub real_hairs: f32,
    /// Width of a drawn strand as a multiple of what its real hairs would cover: 0.05 to 2.
    pub width_scale: f32,
    /// Strength of the first highlight, in the light's colour: 0 to 2.
    pub primary_strength: f32,
    /// Strength of the second highlight, in the hair's colour: 0 to 2.
    pub secondary_strength: f32,
    /// Width of the highlights along the hair: 0.05 (silky) to 1 (dull).
    pub roughness: f32,
}

impl Default for HairLook {
    fn default() -> Self {
        Self {
            eumelanin: 1.3,
            pheomelanin: 0.1,
            variation: 0.25,
            tip_lightening: 0.15,
            diameter: 80e-6,
            real_hairs: 100_000.0,
            width_scale: 0.3,
            primary_strength: 0.6,
            secondary_strength: 0.8,
            roughness: 0.3,
        }
    }
}

impl HairLook {
    /// The look with every number inside its range; what is not a number takes the value of the default.
    pub fn clamped(&self) -> Self {
        let d = Self::default();
        Self {
            eumelanin: within(self.eumelanin, 0.0, 8.0, d.eumelanin),
            pheomelanin: within(self.pheomelanin, 0.0, 8.0, d.pheomelanin),
            variation: within(self.variation, 0.0, 1.0, d.variation),
            tip_lightening: within(self.tip_lightening, 0.0, 1.0, d.tip_lightening),
            diameter: within(self.diameter, 17e-6, 100e-6, d.diameter),
            real_hairs: within(self.real_hairs, 1.0, 1e7, d.real_hairs),
            width_scale: within(self.width_scale, 0.05, 2.0, d.width_scale),
            primary_strength: within(self.primary_strength, 0.0, 2.0, d.primary_strength),
            secondary_strength: within(self.secondary_strength, 0.0, 2.0, d.secondary_strength),
            roughness: within(self.roughness, 0.05, 1.0, d.roughness),
        }
    }

    /// Absorption per unit of path through a fibre, linear sRGB.
    ///
    /// Chiang et al. 2016, "A practical and controllable hair and fur model", after d'Eon et al. 2011.
    pub fn absorption(&self) -> Vec3 {
        self.eumelanin.max(0.0) * Vec3::new(0.419, 0.697, 1.37)
            + self.pheomelanin.max(0.0) * Vec3::new(0.187, 0.4, 1.05)
    }

    /// Colour that light has after many fibres, linear sRGB: what a head of hair with this absorption looks like.
    ///
    /// Paths through hair are of many lengths, and the mean of `exp(-sigma * length)` over them falls more slowly
    /// than any one of them: a stretched exponential, `exp(-(path * sigma^0.7))`. A small grey part only ever met
    /// surfaces. With one path length brown hair would be red. The drawing does the same in `strand_shading.wgsl`.
    pub fn body_color(absorption: Vec3) -> Vec3 {
        absorption.map(|sigma| (-Self::BODY_PATH * sigma.powf(Self::STRETCH)).exp() + Self::SURFACE_SHARE)
    }

    /// Factor on the stretched absorption after which light has the colour of the hair.
    pub const BODY_PATH: f32 = 2.8;

    /// Exponent of the absorption: 1 would be one length of path for all light.
    pub const STRETCH: f32 = 0.7;

    /// Share of the light that leaves hair without ever having entered a fibre.
    pub const SURFACE_SHARE: f32 = 0.012;

    /// Effective width in metres with which one of `strands` drawn strands shadows: diameter times the
    /// number of real hairs that it stands for.
    pub fn shadow_width(&self, strands: usize) -> f32 {
        self.diameter * (self.real_hairs / strands.max(1) as f32)
    }
}
