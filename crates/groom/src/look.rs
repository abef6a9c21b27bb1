//! Colour and width of hair.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

/// What hair is made of and how thick it is: everything about its appearance that no light changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct HairLook {
    /// Concentration of eumelanin, the pigment of brown and black hair.
    pub eumelanin: f32,
    /// Concentration of pheomelanin, the pigment of red hair.
    pub pheomelanin: f32,
    /// How much the melanin varies between strands, as a fraction.
    pub variation: f32,
    /// How much less melanin the tips have than the roots, as a fraction.
    pub tip_lightening: f32,
    /// Diameter of one real hair, metres.
    pub diameter: f32,
    /// Number of real hairs that all drawn strands together stand for.
    pub real_hairs: f32,
    /// Width of a drawn strand as a multiple of the width that its real hairs would cover.
    pub width_scale: f32,
    /// Strength of the primary highlight, in the light's colour.
    pub primary_strength: f32,
    /// Strength of the secondary highlight, in the hair's colour.
    pub secondary_strength: f32,
    /// Width of the highlights along the hair: low values are silky, high ones dull.
    pub roughness: f32,
    /// Factor on the optical depth with which strands shadow each other (the symbol *s*).
    ///
    /// It represents the light that hair scatters forward instead of blocking: 1 is a head of opaque fibres, which is black a
    /// centimetre inside.
    pub extinction_scale: f32,
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
            extinction_scale: 0.15,
        }
    }
}

impl Settings for HairLook {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, eumelanin),
            [0.0, 8.0],
            "Eumelanin",
            "Concentration of the pigment of brown and black hair. Higher values are darker.",
        ),
        Setting::number(
            field!(Self, pheomelanin),
            [0.0, 8.0],
            "Pheomelanin",
            "Concentration of the pigment of red hair.",
        ),
        Setting::number(
            field!(Self, variation),
            [0.0, 1.0],
            "Colour variation",
            "How much the colour varies between strands.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, tip_lightening),
            [0.0, 1.0],
            "Tip lightening",
            "How much lighter hair is at its tips than at its roots.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, primary_strength),
            [0.0, 2.0],
            "Primary highlight",
            "Strength of the highlight in the light's colour.",
        ),
        Setting::number(
            field!(Self, secondary_strength),
            [0.0, 2.0],
            "Secondary highlight",
            "Strength of the highlight in the hair's colour.",
        ),
        Setting::number(
            field!(Self, roughness),
            [0.05, 1.0],
            "Roughness",
            "Width of the highlights: narrow on silky hair, broad on dull hair.",
        ),
        Setting::number(
            field!(Self, width_scale),
            [0.05, 2.0],
            "Strand width",
            "Width of a drawn strand, as a multiple of the width of the hairs that it stands for.",
        )
        .logarithmic(),
        Setting::number(
            field!(Self, diameter),
            [17e-6, 100e-6],
            "Hair diameter",
            "Thickness of one real hair. Thicker hair casts denser shadows.",
        )
        .unit(Unit::METRES_AS_UM),
        Setting::number(
            field!(Self, real_hairs),
            [1.0, 1e7],
            "Hair count",
            "Number of real hairs that all drawn strands together stand for. More hair casts denser \
             shadows.",
        )
        .unit(Unit::THOUSANDS)
        .soft([1e4, 2e5]),
        Setting::number(
            field!(Self, extinction_scale),
            [0.01, 4.0],
            "Extinction",
            "How much light a hair blocks. Low values let light through the hair, high ones make its \
             inside dark; 1 is a head of opaque fibres.",
        )
        .symbol("s")
        .logarithmic()
        .decimals(3),
    ];
}

impl HairLook {
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
