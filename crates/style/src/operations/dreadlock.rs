//! Felted locks of even thickness.

use std::f32::consts::TAU;

use glam::Vec2;
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::cord::{CordPlace, CordStrand, Gathering, Plan, cords, gather, lay};
use crate::operate::{Kind, Operate, Subject};

/// Mats hair into dreadlocks of even thickness with rounded ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Dreadlock {
    /// Number of locks.
    pub count: u32,
    /// Length of hair before a lock begins, metres.
    pub start: f32,
    /// Thickness of a lock, metres.
    pub thickness: f32,
    /// How uneven locks are: their thickness and their course, as a fraction.
    pub lumps: f32,
    /// Length over which strands wind once around the lock, metres.
    pub winding: f32,
    /// How far single hairs stand off the surface, metres.
    pub fuzz: f32,
}

impl Default for Dreadlock {
    fn default() -> Self {
        Self { count: 1000, start: 0.01, thickness: 0.01, lumps: 0.4, winding: 0.05, fuzz: 0.002 }
    }
}

impl Settings for Dreadlock {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::count(
            field!(Self, count),
            [1, 1000],
            "Locks",
            "Number of locks, each from one patch of the scalp. At most one per wisp.",
        ),
        Setting::number(
            field!(Self, start),
            [0.0, 0.3],
            "Start",
            "Length of loose hair between the root (or tie) and the start of the lock.",
        )
        .unit(Unit::METRES_AS_CM)
        .soft([0.0, 0.1]),
        Setting::number(field!(Self, thickness), [0.002, 0.05], "Thickness", "Thickness of a lock.")
            .unit(Unit::METRES_AS_MM)
            .soft([0.004, 0.025]),
        Setting::number(
            field!(Self, lumps),
            [0.0, 1.0],
            "Lumps",
            "How much the thickness and the path of a lock vary.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, winding),
            [0.01, 0.5],
            "Winding",
            "Length over which strands wind once around the lock.",
        )
        .unit(Unit::METRES_AS_MM)
        .soft([0.01, 0.15]),
        Setting::number(
            field!(Self, fuzz),
            [0.0, 0.01],
            "Fuzz",
            "How far loose hairs stand out from the surface of a lock.",
        )
        .unit(Unit::METRES_AS_MM),
    ];
}

/// Segments of a strand per thickness of the lock, and the longest, metres.
const SEGMENTS: f32 = 3.0;
const LONGEST_SEGMENT: f32 = 0.004;
/// Length over which the thickness of a lock varies, and over which it sways, metres.
const LUMP: f32 = 0.035;
const SWAY: f32 = 0.08;

impl Dreadlock {
    /// Where a strand runs across its lock at a distance from the start; `phase` belongs to the lock.
    fn place(&self, strand: &CordStrand, phase: [f32; 4], metres: f32) -> Vec2 {
        let [a, b, c, stands] = strand.chance;
        let half = 0.5 * self.thickness;
        // Rounded at the end, as a half sphere.
        let left = ((strand.end - metres) / half).clamp(0.0, 1.0);
        let round = (1.0 - (1.0 - left) * (1.0 - left)).sqrt().max(0.15);
        let turn = TAU * metres / LUMP;
        let lump = 0.6 * (turn + phase[0]).sin() + 0.4 * (2.3 * turn + phase[1]).sin();
        let radius = half * round * (1.0 + 0.3 * self.lumps * lump);
        // Most strands show on the surface, where they wind and change depth irregularly.
        let winds = TAU * metres / self.winding;
        let own = strand.disc.length().sqrt();
        let deep = 0.82 + 0.18 * (winds * (1.1 + 1.3 * a) + TAU * b).sin();
        let angle =
            strand.disc.to_angle() + winds * (0.6 + 0.8 * c) + 0.5 * (winds * (1.7 + a) + TAU * c).sin();
        let off = (winds * (2.0 + 3.0 * b) + TAU * a).sin().max(0.0).powi(3)
            * if stands < 0.35 { 1.0 } else { 0.25 };
        let out = radius * own * deep + self.fuzz * off * round;
        let sway = TAU * metres / SWAY;
        let course =
            Vec2::new((sway + phase[2]).sin(), (0.8 * sway + phase[3]).sin()) * (0.6 * half * self.lumps);
        course + Vec2::from_angle(angle) * out
    }
}

impl Operate for Dreadlock {
    const KIND: Kind = Kind {
        id: "dreadlock",
        label: "Dreadlocks",
        text: "Mats hair into dreadlocks of even thickness with rounded ends.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let plan = Plan { count: self.count, start: self.start, clear: (0.35 * self.thickness).max(0.003) };
        let cords = cords(style, scope, &plan);
        let before = style.guides.clone();
        let join = self.thickness;
        gather(style, scope, &cords, &Gathering { join, amount: 1.0, tightness: 0.8 });
        let segment = (self.thickness / SEGMENTS).min(LONGEST_SEGMENT);
        lay(style, &before, scope, &cords, (join, segment), |cord, strand, metres| {
            let mut random = scope.random(1, cord.members[0].wisp);
            let phase = [(); 4].map(|()| random.angle());
            CordPlace { place: self.place(strand, phase, metres), own: 0.0 }
        });
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::operations::testing::{acted, places, straight};

    #[test]
    fn locks_have_one_thickness_and_rounded_ends() {
        let before = straight(Vec3::NEG_Y);
        let lock = Dreadlock { lumps: 0.0, fuzz: 0.0, ..Dreadlock::default() };
        let after = acted(lock.clone(), &before);
        after.check().expect("sound");
        for wisp in &after.wisps {
            let strands = wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize;
            let all: Vec<Vec<Vec3>> = strands.map(|strand| places(&after, strand)).collect();
            // The wisp hangs straight down: its middle has one x and z beyond the start.
            let guide =
                |i: usize| wisp.guides.map(|g| after.guides.point(g as usize, i)).iter().sum::<Vec3>() / 3.0;
            let middle = guide(20);
            let off = |p: &Vec3| (*p - middle).with_y(0.0).length();
            let lowest = all.iter().flatten().map(|p| p.y).fold(f32::MAX, f32::min);
            for p in all.iter().flatten().filter(|p| p.y < middle.y) {
                assert!(off(p) < 0.5 * lock.thickness * 1.05, "{} at {}", off(p), p.y);
                assert!(p.y > lowest + 1e-4 || off(p) < 0.2 * lock.thickness, "{} at the end", off(p));
            }
            let widest = all.iter().flatten().filter(|p| p.y < middle.y).map(off).fold(0.0, f32::max);
            assert!(widest > 0.3 * lock.thickness, "{widest}");
        }
    }
}
