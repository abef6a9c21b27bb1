//! Dye.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use super::{dyed, recolour};
use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// Dyes hair, which may be bleached first.
#[derive(Clone, Debug, PartialEq)]
pub struct Dye {
    /// Colour of much hair of this dye in white light, linear sRGB.
    pub color: Vec3,
    /// How much of the dye hair takes, 0 to 1.
    pub amount: f32,
    /// How much of the pigment below the dye replaces; the rest stays under it.
    pub bleach: f32,
}

impl Default for Dye {
    fn default() -> Self {
        Self { color: Vec3::new(0.25, 0.02, 0.08), amount: 1.0, bleach: 1.0 }
    }
}

impl Settings for Dye {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::color(
            field!(Self, color),
            "Dye",
            "Colour of the dye, as a head of dyed hair looks in white light.",
        ),
        Setting::number(field!(Self, amount), [0.0, 1.0], "Amount", "How strongly the dye colours the hair.")
            .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, bleach),
            [0.0, 1.0],
            "Bleach first",
            "How much of the colour below is bleached away where the dye is applied. At 0 % the dye is a tint over it, \
             which can only darken.",
        )
        .unit(Unit::FRACTION),
    ];
}

impl Operate for Dye {
    const KIND: Kind = Kind {
        id: "dye",
        label: "Dye",
        text: "Dyes hair in any colour, over bleached hair or as a tint.",
        subject: Subject::Colour,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let absorption = dyed(self.color);
        recolour(style, scope, |at, below| {
            let share = self.amount * at.share();
            below.faded(1.0 - self.bleach * share).with(absorption * share)
        });
    }
}
