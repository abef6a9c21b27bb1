//! A streak of another colour.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use super::{dyed, recolour};
use crate::Scope;
use crate::operate::{Kind, Operate, Subject};
use crate::scope::strand_roots;

/// Dyes or bleaches the strands of a stripe of the scalp that runs from the forehead backward.
#[derive(Clone, Debug, PartialEq)]
pub struct Streak {
    /// Colour of the streak, linear sRGB.
    pub color: Vec3,
    /// How far the colour replaces what is below.
    pub amount: f32,
    /// How much of the pigment below is bleached first.
    pub bleach: f32,
    /// Where the middle of the stripe is, as a fraction of half the head: 1 is the wearer's left side.
    pub sideways: f32,
    /// Width of the stripe in the same measure.
    pub width: f32,
    /// Where the stripe ends: 1 is the face and -1 the back of the head.
    pub back: f32,
    /// How ragged its sides are, as a fraction of its width.
    pub ragged: f32,
}

impl Default for Streak {
    fn default() -> Self {
        Self {
            color: Vec3::new(0.45, 0.012, 0.02),
            amount: 1.0,
            bleach: 1.0,
            sideways: 0.4,
            width: 0.25,
            back: 0.0,
            ragged: 0.35,
        }
    }
}

impl Settings for Streak {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::color(field!(Self, color), "Colour", "Colour of the streak in white light."),
        Setting::number(
            field!(Self, amount),
            [0.0, 1.0],
            "Amount",
            "How strongly the streak is dyed. At 0 % it is only bleached.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, bleach),
            [0.0, 1.0],
            "Bleach first",
            "How much of the colour underneath is bleached out.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, sideways),
            [-1.0, 1.0],
            "Sideways",
            "Sideways position as a fraction of half the head: 100 % is the wearer's left side.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, width),
            [0.0, 2.0],
            "Width",
            "Width of the streak at the roots, as a fraction of half the head.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, back),
            [-1.5, 1.0],
            "Back end",
            "How far back the streak reaches: 100 % ends at the face, -100 % at the back of the head.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, ragged),
            [0.0, 1.0],
            "Ragged sides",
            "Part of the width over which strands of both colours mix at the edges.",
        )
        .unit(Unit::FRACTION),
    ];
}

/// Purpose of the random numbers.
const STRANDS: u32 = 0xc5;

impl Operate for Streak {
    const KIND: Kind = Kind {
        id: "streak",
        label: "Streak",
        text: "Dyes or bleaches one streak from the forehead backward.",
        subject: Subject::Colour,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let half = 0.5 * self.width;
        let mixed = self.ragged * half;
        let inside = |(strand, root): (usize, Vec3)| {
            let root = scope.head.relative(root);
            // How far inside of the stripe the root is.
            let depth = (half - (root.x - self.sideways).abs()).min(root.z - self.back);
            let share = if mixed > 0.0 { smoothstep(-mixed, mixed, depth) } else { f32::from(depth >= 0.0) };
            scope.random(STRANDS, strand).unit() < share
        };
        let inside: Vec<bool> = strand_roots(style).into_iter().enumerate().map(inside).collect();
        let absorption = dyed(self.color);
        recolour(style, scope, |at, below| {
            if !inside[at.strand] {
                return below;
            }
            let share = at.share();
            below.faded(1.0 - self.bleach * share).with(absorption * (self.amount * share))
        });
    }
}
