//! Another colour toward the tips: ombré and balayage.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use lovelock_groom::Hairstyle;
use lovelock_groom::fine::locks_of_wisps;

use super::{by_lock, dyed, natural, recolour};
use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// What colours the tips.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GradientPigment {
    /// Natural pigment.
    #[default]
    Melanin,
    /// A dye.
    Dye,
}

impl Choices for GradientPigment {
    const ALL: &'static [Self] = &[Self::Melanin, Self::Dye];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Melanin => ("melanin", "Natural colour"),
            Self::Dye => ("dye", "Dye"),
        }
    }
}

/// Blends into another colour toward the tips.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    /// What colours the tips.
    pub pigment: GradientPigment,
    /// Concentration of eumelanin at the tips, if it is natural.
    pub eumelanin: f32,
    /// Concentration of pheomelanin at the tips, if it is natural.
    pub pheomelanin: f32,
    /// Colour of the tips, if it is a dye; linear sRGB.
    pub color: Vec3,
    /// The fraction of the strand from the root at which the gradient begins.
    pub start: f32,
    /// Length of the blend, as a fraction of the strand.
    pub length: f32,
    /// How much the beginning differs between locks, as a fraction of the strand.
    pub variation: f32,
    /// Locks of a wisp.
    pub locks: u32,
}

impl Default for Gradient {
    fn default() -> Self {
        Self {
            pigment: GradientPigment::Melanin,
            eumelanin: 0.22,
            pheomelanin: 0.12,
            color: Vec3::new(0.55, 0.12, 0.2),
            start: 0.35,
            length: 0.4,
            variation: 0.2,
            locks: 6,
        }
    }
}

impl Settings for Gradient {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<GradientPigment>(
            field!(Self, pigment),
            "Tips",
            "Kind of colour at the tips: natural or dyed.",
        ),
        Setting::number(
            field!(Self, eumelanin),
            [0.0, 8.0],
            "Eumelanin",
            "Brown and black pigment at the tips, for a natural colour.",
        ),
        Setting::number(
            field!(Self, pheomelanin),
            [0.0, 8.0],
            "Pheomelanin",
            "Red pigment at the tips, for a natural colour.",
        ),
        Setting::color(field!(Self, color), "Dye", "Colour of dyed tips."),
        Setting::number(
            field!(Self, start),
            [0.0, 1.0],
            "Start",
            "Distance from the root at which the blend begins, as a fraction of the strand.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, length),
            [0.0, 1.0],
            "Length",
            "Length of the blend between the colours.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, variation),
            [0.0, 1.0],
            "Variation",
            "How much the start of the blend varies between locks. At 0 % it is one line around the head.",
        )
        .unit(Unit::FRACTION),
        Setting::count(
            field!(Self, locks),
            [1, 16],
            "Locks per wisp",
            "Number of locks per wisp. More locks are finer.",
        ),
    ];
}

/// Purpose of the random numbers.
const STARTS: u32 = 0xc1;

impl Operate for Gradient {
    const KIND: Kind = Kind {
        id: "gradient",
        label: "Gradient",
        text: "Blends into another colour toward the tips: ombré and balayage.",
        subject: Subject::Colour,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let absorption = match self.pigment {
            GradientPigment::Melanin => natural(self.eumelanin, self.pheomelanin),
            GradientPigment::Dye => dyed(self.color),
        };
        let offsets = by_lock(scope, STARTS, &locks_of_wisps(&style.strands, self.locks as usize));
        recolour(style, scope, |at, below| {
            let start = self.start + self.variation * (offsets[at.strand] - 0.5);
            let reached = smoothstep(start, start + self.length.max(1e-3), at.place);
            below.toward(absorption, reached * at.share())
        });
    }
}
