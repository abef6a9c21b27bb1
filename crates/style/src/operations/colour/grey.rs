//! Grey hair.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::{Hairstyle, UNPIGMENTED};

use super::recolour;
use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// Takes the pigment from some strands.
#[derive(Clone, Debug, PartialEq)]
pub struct Grey {
    /// Share of the strands.
    pub share: f32,
    /// What is left of their pigment, as a fraction.
    pub left: f32,
}

impl Default for Grey {
    fn default() -> Self {
        Self { share: 0.4, left: UNPIGMENTED }
    }
}

impl Settings for Grey {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, share),
            [0.0, 1.0],
            "Share",
            "Share of the strands that are grey. The layer's mask and weight make it smaller: at the border of a mask there \
             are fewer grey strands.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, left),
            [0.0, 1.0],
            "Pigment left",
            "Pigment that remains in grey strands. White hair has almost none.",
        )
        .unit(Unit::FRACTION),
    ];
}

/// Purpose of the random numbers.
const STRANDS: u32 = 0xc4;

impl Operate for Grey {
    const KIND: Kind = Kind {
        id: "grey",
        label: "Grey",
        text: "Removes pigment from a share of the strands, scattered over the head or within the mask.",
        subject: Subject::Colour,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let own: Vec<f32> =
            (0..style.strands.count()).map(|strand| scope.random(STRANDS, strand).unit()).collect();
        recolour(style, scope, |at, below| {
            if own[at.strand] >= self.share * at.strength {
                return below;
            }
            below.faded(1.0 - (1.0 - self.left) * at.along.clamp(0.0, 1.0))
        });
    }
}
