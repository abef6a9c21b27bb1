//! Colour and width of hair.

use std::fmt;
use std::str::FromStr;

use glam::Vec3;
use lovelock_appearance::fibre::{Fibre, pigment};
use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

/// How light that meets a strand is shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HairShading {
    /// Scattering by a fibre and by the many fibres around it: see [`lovelock_appearance::fibre`].
    #[default]
    Fibre,
    /// Two shifted highlights, a matt part and light through the fibre, after Kajiya, Kay 1989 and Marschner and others 2003.
    // The name in files before there was the published model.
    #[serde(alias = "kajiya-kay")]
    TwoHighlights,
    /// One highlight and a matt part (Kajiya, Kay 1989), with ambient light that hair does not shadow, as the papers on shadows of
    /// hair use it.
    KajiyaKayPublished,
}

impl Choices for HairShading {
    const ALL: &'static [Self] = &[Self::Fibre, Self::TwoHighlights, Self::KajiyaKayPublished];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Fibre => ("fibre", "Fibre scattering"),
            Self::TwoHighlights => ("two-highlights", "Two highlights"),
            Self::KajiyaKayPublished => ("kajiya-kay-published", "Kajiya-Kay, as published"),
        }
    }
}

impl fmt::Display for HairShading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.names().0)
    }
}

impl FromStr for HairShading {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        Self::ALL.iter().copied().find(|shading| shading.names().0 == id).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|shading| shading.names().0).collect();
            format!("unknown shading `{id}`: must be one of {}", known.join(", "))
        })
    }
}

/// What hair is made of and how thick it is: everything about its appearance that no light changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct HairLook {
    /// Concentration of eumelanin, the pigment of brown and black hair.
    pub eumelanin: f32,
    /// Concentration of pheomelanin, the pigment of red hair.
    pub pheomelanin: f32,
    /// How light is shaded.
    pub shading: HairShading,
    /// Share of strands without pigment.
    pub grey: f32,
    /// Colour of the dye, linear sRGB: what much hair of that dye looks like in white light.
    pub dye: Vec3,
    /// Share of the dye in the pigment: 0 natural, 1 dye alone.
    pub dye_amount: f32,
    /// Share of the locks that are lightened.
    pub highlights: f32,
    /// How much less pigment those have, as a fraction.
    pub highlight_lightening: f32,
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
    /// Width of the highlights along the hair: low values are silky, high ones dull. Symbol: `beta_m`.
    pub roughness: f32,
    /// Width of the scattering around the strand: low values are glassy, high ones soft. Symbol: `beta_n`.
    pub roughness_around: f32,
    /// Angle by which the scales of a hair open toward its tip, radians.
    pub scale_tilt: f32,
    /// Index of refraction of the fibre.
    pub refraction: f32,
    /// Share of the light that reaches the eye by way of other strands, 0 to 1.
    pub many_scattering: f32,
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
            shading: HairShading::default(),
            grey: 0.0,
            dye: Vec3::new(0.25, 0.02, 0.08),
            dye_amount: 0.0,
            highlights: 0.0,
            highlight_lightening: 0.6,
            variation: 0.25,
            tip_lightening: 0.15,
            diameter: 80e-6,
            real_hairs: 100_000.0,
            width_scale: 0.3,
            primary_strength: 0.6,
            secondary_strength: 0.8,
            roughness: 0.2,
            roughness_around: 0.3,
            scale_tilt: 2.0_f32.to_radians(),
            refraction: 1.55,
            many_scattering: 1.0,
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
            field!(Self, grey),
            [0.0, 1.0],
            "Grey",
            "Share of strands without pigment. All strands are white at 100 %.",
        )
        .unit(Unit::FRACTION),
        Setting::color(
            field!(Self, dye),
            "Dye",
            "Colour of the dye, as a head of dyed hair looks in white light.",
        ),
        Setting::number(
            field!(Self, dye_amount),
            [0.0, 1.0],
            "Dye amount",
            "How far the dye replaces the natural pigment.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, highlights),
            [0.0, 1.0],
            "Lightened locks",
            "Share of the locks that are lightened, as a hairdresser paints highlights.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, highlight_lightening),
            [0.0, 1.0],
            "Lightening",
            "How much pigment is removed from lightened locks.",
        )
        .unit(Unit::FRACTION),
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
        Setting::choice::<HairShading>(
            field!(Self, shading),
            "Shading",
            "How light on hair is computed: by scattering in the fibres, by two shifted highlights and a matt part, or by one \
             highlight and a matt part as Kajiya and Kay published.",
        ),
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
            "Width of the highlights along the strand: narrow on silky hair, broad on dull hair.",
        ),
        Setting::number(
            field!(Self, roughness_around),
            [0.05, 1.0],
            "Roughness around",
            "Width of the scattering around the strand: glassy at low values, soft at high ones. Light \
             hair looks more saturated with rough fibres.",
        ),
        Setting::number(
            field!(Self, scale_tilt),
            [0.0, 0.18],
            "Scale tilt",
            "Angle of the scales of a hair, which moves the first highlight toward the root and the \
             second toward the tip.",
        )
        .unit(Unit::RADIANS)
        .decimals(1),
        Setting::number(
            field!(Self, refraction),
            [1.1, 2.0],
            "Refraction",
            "Index of refraction of a hair; natural hair has 1.55. Higher values shine more.",
        ),
        Setting::number(
            field!(Self, many_scattering),
            [0.0, 1.0],
            "Between strands",
            "Share of the light scattered between strands that is drawn. Without it light hair is too dark.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, width_scale),
            [0.05, 2.0],
            "Strand width",
            "Width of a drawn strand, relative to the total width of the hairs that it represents.",
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
            "Number of real hairs that the drawn strands represent. More hair casts denser shadows.",
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
    /// The settings that are no part of a style.
    ///
    /// How much light a hair blocks belongs to the rendering of shadows: it makes up for the number of drawn strands and the lights, and
    /// all compared methods share it. It is therefore set with the shadow, and choosing a style in the browser does not undo it. Files store
    /// it with the look because every shadow method reads it from there.
    pub const SHARED: [&str; 1] = ["extinction_scale"];

    /// The look of a style in place of this one, without the settings in [`HairLook::SHARED`].
    #[must_use]
    pub fn with_style(&self, style: &Self) -> Self {
        Self { extinction_scale: self.extinction_scale, ..*style }
    }

    /// Absorption per unit of path through a fibre, linear sRGB.
    ///
    /// Chiang et al. 2016, "A practical and controllable hair and fur model", after d'Eon et al. 2011; of the strands that have pigment,
    /// before any variation.
    pub fn absorption(&self) -> Vec3 {
        let as_vec3 = |of: [f64; 3]| Vec3::from(of.map(|sigma| sigma as f32));
        let natural = as_vec3(pigment::absorption_of_melanin(self.eumelanin.into(), self.pheomelanin.into()));
        let amount = self.dye_amount.clamp(0.0, 1.0);
        if amount > 0.0 {
            natural.lerp(Self::absorption_of_dye(self.dye, self.roughness_around), amount)
        } else {
            natural
        }
    }

    /// Absorption of a dye, as [`HairLook::absorption`], of hair with that roughness around the strand; see [`HairLook::dye`].
    pub fn absorption_of_dye(color: Vec3, roughness_around: f32) -> Vec3 {
        let color = color.to_array().map(f64::from);
        let sigma = pigment::absorption_of_color(color, roughness_around.into());
        Vec3::from(sigma.map(|sigma| sigma as f32))
    }

    /// The shape of the fibres.
    pub fn fibre(&self) -> Fibre {
        let fibre = Fibre {
            roughness_along: self.roughness.into(),
            roughness_around: self.roughness_around.into(),
            // Scales open toward the tip, and the tangent of a strand points there.
            tilt: -f64::from(self.scale_tilt),
            index: self.refraction.into(),
        };
        fibre.clamped()
    }

    /// Colour that light has after many fibres, linear sRGB: what a head of hair with this absorption looks like.
    ///
    /// Paths through hair are of many lengths, and the mean of `exp(-sigma * length)` over them falls more slowly
    /// than any one of them: a stretched exponential, `exp(-(path * sigma^0.7))`. A small grey part only ever met
    /// surfaces. With one path length brown hair would be red. The drawing does the same in `two_highlights.wgsl`.
    pub fn body_color(absorption: Vec3) -> Vec3 {
        absorption.map(|sigma| (-Self::BODY_PATH * sigma.powf(Self::STRETCH)).exp() + Self::SURFACE_SHARE)
    }

    /// Factor on the stretched absorption after which light has the colour of the hair.
    pub const BODY_PATH: f32 = 5.2;

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

#[cfg(test)]
mod tests {
    use serde::de::IntoDeserializer;
    use serde::de::value::{Error, StrDeserializer};

    use super::*;

    #[test]
    fn files_have_the_ids_of_shadings_and_the_old_name_of_two_highlights() {
        let read = |id: &str| {
            let text: StrDeserializer<'_, Error> = id.into_deserializer();
            HairShading::deserialize(text)
        };
        for &shading in HairShading::ALL {
            let id = shading.names().0;
            assert_eq!((read(id), id.parse()), (Ok(shading), Ok(shading)));
        }
        assert_eq!(read("kajiya-kay"), Ok(HairShading::TwoHighlights));
        assert!(read("kajiya").is_err() && "kajiya-kay".parse::<HairShading>().is_err());
    }
}
