//! Lightened or coloured locks.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;
use lovelock_groom::fine::locks_of_wisps;

use super::{by_lock, dyed, recolour};
use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// Lightens some locks, or some strands of them, and may tone them with a colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Highlights {
    /// Share of the locks.
    pub share: f32,
    /// Share of the strands of those locks.
    pub strands: f32,
    /// How much less pigment they have, as a fraction.
    pub lightening: f32,
    /// How much of the toner they take.
    pub toning: f32,
    /// Colour of the toner, linear sRGB.
    pub toner: Vec3,
    /// The fraction of the strand from the root from which on it is coloured.
    pub start: f32,
    /// The fraction of the strand over which the colour fades in.
    pub fade: f32,
    /// Locks of a wisp.
    pub locks: u32,
}

impl Default for Highlights {
    fn default() -> Self {
        Self {
            share: 0.35,
            strands: 0.8,
            lightening: 0.65,
            toning: 0.0,
            toner: Vec3::new(0.62, 0.42, 0.2),
            start: 0.0,
            fade: 0.25,
            locks: 8,
        }
    }
}

impl Settings for Highlights {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, share), [0.0, 1.0], "Locks", "Share of the locks that are lightened.")
            .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, strands),
            [0.0, 1.0],
            "Strands",
            "Share of strands that are lightened within those locks. Low values look fine and soft; 100 % lightens whole locks.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, lightening),
            [0.0, 1.0],
            "Lightening",
            "How much pigment lightening removes.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, toning),
            [0.0, 1.0],
            "Toning",
            "How strongly the toner colours the lightened hair.",
        )
        .unit(Unit::FRACTION),
        Setting::color(
            field!(Self, toner),
            "Toner",
            "Colour of the toner, as a head of toned hair looks in white light.",
        ),
        Setting::number(
            field!(Self, start),
            [0.0, 1.0],
            "Start",
            "Distance from the root at which lightening begins, as a fraction of the strand.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, fade),
            [0.0, 1.0],
            "Fade",
            "Length of the transition into the lightened part. Low values look freshly done, high ones grown out.",
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

/// Purposes of the random numbers.
const LOCKS: u32 = 0xc2;
const STRANDS: u32 = 0xc3;

impl Operate for Highlights {
    const KIND: Kind = Kind {
        id: "highlights",
        label: "Highlights",
        text: "Lightens some locks, as a hairdresser paints highlights.",
        subject: Subject::Colour,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let locks = locks_of_wisps(&style.strands, self.locks as usize);
        let own = by_lock(scope, LOCKS, &locks);
        let chosen: Vec<bool> = own
            .iter()
            .enumerate()
            .map(|(strand, lock)| *lock < self.share && scope.random(STRANDS, strand).unit() < self.strands)
            .collect();
        let toner = dyed(self.toner);
        recolour(style, scope, |at, below| {
            if !chosen[at.strand] {
                return below;
            }
            let painted = if self.fade > 0.0 {
                smoothstep(self.start, self.start + self.fade, at.place)
            } else {
                f32::from(at.place >= self.start)
            };
            let share = painted * at.share();
            below.faded(1.0 - self.lightening * share).toward(toner, self.toning * share)
        });
    }
}
