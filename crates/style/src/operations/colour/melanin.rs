//! Natural pigment.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings};
use lovelock_groom::Hairstyle;

use super::{natural, recolour};
use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// Gives hair another natural colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Melanin {
    /// Concentration of eumelanin, in the units of [`HairLook`](lovelock_groom::HairLook).
    pub eumelanin: f32,
    /// Concentration of pheomelanin.
    pub pheomelanin: f32,
}

impl Default for Melanin {
    fn default() -> Self {
        Self { eumelanin: 0.3, pheomelanin: 0.8 }
    }
}

impl Settings for Melanin {
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
    ];
}

impl Operate for Melanin {
    const KIND: Kind = Kind {
        id: "melanin",
        label: "Natural colour",
        text: "Gives hair another natural colour through its two pigments.",
        subject: Subject::Colour,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let absorption = natural(self.eumelanin, self.pheomelanin);
        recolour(style, scope, |at, below| below.toward(absorption, at.share()));
    }
}
