//! Brows and lashes.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use lovelock_groom::HairLook;
use lovelock_groom::carried::{BROWS, LOWER_LASHES, SkinGroom, UPPER_LASHES};
use serde::{Deserialize, Serialize};

/// Where brows have their colour from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum BrowColour {
    /// The natural colour of the hair, darker.
    #[default]
    Hair,
    /// [`BrowSection::color`].
    Own,
}

impl Choices for BrowColour {
    const ALL: &'static [Self] = &[Self::Hair, Self::Own];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Hair => ("Hair", "As the hair"),
            Self::Own => ("Own", "Own"),
        }
    }
}

/// Brows and lashes: hair that the skin of a body carries where its file says so.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BrowSection {
    /// Number of hairs of the brows as a multiple of the usual one; 0 for none.
    pub brows: f32,
    /// Number of lashes as a multiple of the usual one; 0 for none.
    pub lashes: f32,
    /// Length of both as a multiple of the usual one.
    pub length: f32,
    /// Thickness of both as a multiple of the usual one.
    pub thickness: f32,
    /// Where brows have their colour from.
    pub colour: BrowColour,
    /// Their own colour, linear sRGB: what many such hairs look like in white light.
    pub color: Vec3,
    /// Share of their hairs without pigment.
    pub grey: f32,
}

impl Default for BrowSection {
    fn default() -> Self {
        Self {
            brows: 1.0,
            lashes: 1.0,
            length: 1.0,
            thickness: 1.0,
            colour: BrowColour::default(),
            color: Vec3::new(0.05, 0.03, 0.02),
            grey: 0.0,
        }
    }
}

impl Settings for BrowSection {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, brows),
            [0.0, 3.0],
            "Brows",
            "Density of the brows. Without any at 0 %. Bodies have brows where their file contains the vertex attribute _BROW.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, lashes),
            [0.0, 3.0],
            "Lashes",
            "Density of the lashes. Without any at 0 %. Bodies have lashes where their file contains the vertex attributes \
             _LASH_UPPER and _LASH_LOWER.",
        )
        .unit(Unit::FRACTION),
        Setting::number(field!(Self, length), [0.2, 3.0], "Length", "Length of brows and lashes.")
            .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, thickness),
            [0.2, 4.0],
            "Thickness",
            "Thickness of the hairs of brows and lashes.",
        )
        .unit(Unit::FRACTION),
        Setting::choice::<BrowColour>(
            field!(Self, colour),
            "Brow colour",
            "The natural colour of the hair with three times its pigment, without dye, or a colour of their own.",
        ),
        Setting::color(field!(Self, color), "Own colour", "Colour of the brows, if it is not that of the hair."),
        Setting::number(
            field!(Self, grey),
            [0.0, 1.0],
            "Grey brows",
            "Share of the hairs of the brows without pigment.",
        )
        .unit(Unit::FRACTION),
    ];
}

/// The least and the most eumelanin of brows in the colour of the hair.
const EUMELANIN: [f32; 2] = [0.8, 8.0];
/// How many times the pigment of the hair they have. Their strands add nothing to it.
const DARKER: f32 = 3.0;
/// The eumelanin that they have where the hair has none.
const ADDED: f32 = 0.3;
/// The most pheomelanin: brows of red hair are auburn.
const MAX_PHEOMELANIN: f32 = 2.7;

impl BrowSection {
    /// The grooms of brows and lashes; those without hair are left out.
    pub fn grooms(&self) -> Vec<SkinGroom> {
        let scaled = |groom: SkinGroom, density: f32| SkinGroom {
            strands: groom.strands * density,
            length: groom.length.map(|length| length * self.length),
            ..groom
        };
        let all =
            [scaled(BROWS, self.brows), scaled(UPPER_LASHES, self.lashes), scaled(LOWER_LASHES, self.lashes)];
        all.into_iter().filter(|groom| groom.strands > 0.0).collect()
    }

    /// The look of brows beside hair of the look `of_hair`, whose strands are at most `width` metres wide and so many.
    pub fn look(&self, of_hair: &HairLook, width: f32, strands: usize) -> HairLook {
        let look = HairLook {
            grey: self.grey,
            dye_amount: 0.0,
            highlights: 0.0,
            tip_lightening: 0.0,
            diameter: width * self.thickness,
            // As wide as it is, however many strands the hairstyle has.
            real_hairs: strands as f32,
            width_scale: 1.0,
            ..*of_hair
        };
        match self.colour {
            BrowColour::Hair => HairLook {
                eumelanin: (look.eumelanin * DARKER + ADDED).clamp(EUMELANIN[0], EUMELANIN[1]),
                pheomelanin: (look.pheomelanin * DARKER).clamp(0.0, MAX_PHEOMELANIN),
                ..look
            },
            BrowColour::Own => HairLook { dye: self.color, dye_amount: 1.0, ..look },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brows_have_a_natural_colour_that_is_not_lighter_than_the_hair() {
        let section = BrowSection::default();
        for eumelanin in [0.0, 0.06, 1.3, 8.0] {
            let hair =
                HairLook { eumelanin, dye_amount: 1.0, dye: Vec3::X, grey: 1.0, ..HairLook::default() };
            let brows = section.look(&hair, 1e-4, 500);
            assert_eq!((brows.dye_amount, brows.grey), (0.0, 0.0));
            assert!(brows.eumelanin >= eumelanin.max(0.5) && brows.eumelanin <= 8.0);
            assert_eq!(brows.shadow_width(500), brows.diameter, "a width of its own");
        }
        let own = BrowSection { colour: BrowColour::Own, grey: 0.7, ..section };
        let look = own.look(&HairLook::default(), 1e-4, 500);
        assert_eq!((look.dye, look.dye_amount, look.grey), (own.color, 1.0, 0.7));
    }

    #[test]
    fn strands_of_brows_absorb_what_the_setting_says() {
        // What reaches a strand: the absorption of the look, changed by the colour of the groom.
        let of_strand = |section: &BrowSection, hair: &HairLook| {
            BROWS.colour.absorption(section.look(hair, 1e-4, 500).absorption())
        };
        let hair = HairLook { eumelanin: 1.3, pheomelanin: 0.2, dye_amount: 0.0, ..HairLook::default() };
        let ratio = of_strand(&BrowSection::default(), &hair) / hair.absorption();
        assert!(ratio.min_element() > 2.9 && ratio.max_element() < 3.6, "{ratio}");
        let own = BrowSection {
            colour: BrowColour::Own,
            color: Vec3::new(0.4, 0.2, 0.1),
            ..BrowSection::default()
        };
        let chosen = HairLook::absorption_of_dye(own.color, hair.roughness_around);
        assert!(of_strand(&own, &hair).abs_diff_eq(chosen, 1e-5));
        // Hairs without pigment get none by the groom.
        assert_eq!(BROWS.colour.absorption(Vec3::ZERO), Vec3::ZERO);
    }

    #[test]
    fn density_is_that_of_the_setting() {
        let section = BrowSection { brows: 0.0, lashes: 0.5, length: 2.0, ..BrowSection::default() };
        let grooms = section.grooms();
        assert_eq!(grooms.len(), 2);
        assert_eq!(grooms[0].strands, 0.5 * UPPER_LASHES.strands);
        assert_eq!(grooms[1].length, LOWER_LASHES.length.map(|length| 2.0 * length));
        assert_eq!(BrowSection::default().grooms(), [BROWS, UPPER_LASHES, LOWER_LASHES]);
    }
}
