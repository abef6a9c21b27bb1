//! Plaits of three strands: one for each tie, or one for each patch of the scalp.

mod weave;

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::cord::{CordPlace, Gathering, Plan, cords, gather, lay};
use crate::operate::{Kind, Operate, Subject};
use weave::{THICKNESS, Weave};

/// Plaits hair in three bundles that cross over and under.
#[derive(Clone, Debug, PartialEq)]
pub struct Braid {
    /// Number of braids of loose hair. Hair that ties hold makes one for each tie.
    pub count: u32,
    /// Length of hair before the braid begins, from the tie or the root, metres.
    pub start: f32,
    /// Width of the braid, metres.
    pub width: f32,
    /// Distance between two crossings on one side, metres.
    pub pitch: f32,
    /// How tightly the bundles are gathered, as a fraction.
    pub tightness: f32,
    /// How much narrower the braid is at its end, as a fraction.
    pub taper: f32,
    /// Length of loose hair below the end of the braid, metres.
    pub tassel: f32,
    /// Share of strands that leave their bundle.
    pub flyaways: f32,
}

impl Default for Braid {
    fn default() -> Self {
        Self {
            count: 1,
            start: 0.02,
            width: 0.03,
            pitch: 0.022,
            tightness: 0.7,
            taper: 0.4,
            tassel: 0.05,
            flyaways: 0.03,
        }
    }
}

impl Settings for Braid {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::count(
            field!(Self, count),
            [1, 1000],
            "Braids",
            "Number of braids in loose hair, each from one patch of the scalp. Tied hair makes one braid per tie.",
        ),
        Setting::number(
            field!(Self, start),
            [0.0, 1.0],
            "Start",
            "Length of loose hair between the root (or tie) and the start of the braid.",
        )
        .unit(Unit::METRES_AS_CM)
        .soft([0.0, 0.3]),
        Setting::number(field!(Self, width), [0.002, 0.12], "Width", "Width of the braid at its start.")
            .unit(Unit::METRES_AS_MM)
            .soft([0.004, 0.06]),
        Setting::number(
            field!(Self, pitch),
            [0.002, 0.2],
            "Pitch",
            "Distance between two crossings on one side. Two thirds of the width gives a firm braid.",
        )
        .unit(Unit::METRES_AS_MM)
        .soft([0.003, 0.06]),
        Setting::number(
            field!(Self, tightness),
            [0.0, 1.0],
            "Tightness",
            "How tightly each bundle is gathered. Low values look soft and uneven.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, taper),
            [0.0, 0.9],
            "Taper",
            "How much narrower the braid is at its end than at its start.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, tassel),
            [0.0, 0.5],
            "Tassel",
            "Length of loose hair below the end of the braid.",
        )
        .unit(Unit::METRES_AS_CM)
        .soft([0.0, 0.2]),
        Setting::number(
            field!(Self, flyaways),
            [0.0, 0.5],
            "Flyaways",
            "Share of strands that come loose from their bundle.",
        )
        .unit(Unit::FRACTION),
    ];
}

/// Segments of a strand between two crossings on one side.
const SEGMENTS: f32 = 5.0;
/// The share of a braid's thickness by which its middle stays away from the body.
const CLEAR: f32 = 0.35;

impl Operate for Braid {
    const KIND: Kind = Kind {
        id: "braid",
        label: "Braid",
        text: "Braids hair in three bundles that cross over and under: one braid per tie, or many.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let clear = (CLEAR * THICKNESS * self.width).max(0.003);
        let cords = cords(style, scope, &Plan { count: self.count, start: self.start, clear });
        let before = style.guides.clone();
        let join = self.pitch;
        let tightness = 0.5 + 0.5 * self.tightness;
        gather(style, scope, &cords, &Gathering { join, amount: 1.0, tightness });
        let segment = self.pitch / SEGMENTS;
        lay(style, &before, scope, &cords, (join, segment), |_, strand, metres| {
            let weave = Weave::new(self, strand.end);
            CordPlace { place: weave.place(strand, metres), own: 0.0 }
        });
    }
}

#[cfg(test)]
mod tests;
