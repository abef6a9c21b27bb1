//! Gathers each lock and winds it in a helix.

use std::f32::consts::TAU;

use glam::Vec2;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::cord::{CordPlace, Gathering, Plan, cords, gather, lay};
use crate::operate::{Kind, Operate, Subject};

/// Gathers each lock and winds it into a helix, like corkscrew curls.
#[derive(Clone, Debug, PartialEq)]
pub struct Coil {
    /// Radius of the helix, metres.
    pub radius: f32,
    /// Length of one turn, metres.
    pub pitch: f32,
    /// How far the hair of a lock comes together, as a fraction.
    pub gather: f32,
    /// Distance from the root over which locks gather and wind, metres.
    pub onset: f32,
    /// How much radius and pitch vary along a lock and between locks, as a fraction.
    pub variation: f32,
}

impl Default for Coil {
    fn default() -> Self {
        Self { radius: 0.006, pitch: 0.03, gather: 0.8, onset: 0.04, variation: 0.3 }
    }
}

impl Settings for Coil {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, radius), [0.0, 0.04], "Radius", "Radius of the coils.")
            .unit(Unit::METRES_AS_MM),
        Setting::number(field!(Self, pitch), [0.004, 0.4], "Pitch", "Length of one turn.")
            .unit(Unit::METRES_AS_MM)
            .soft([0.004, 0.1]),
        Setting::number(
            field!(Self, gather),
            [0.0, 1.0],
            "Gather",
            "How tightly the hair of a lock is gathered.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, onset),
            [0.0, 0.3],
            "Onset",
            "Length from the root over which the coil forms.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, variation),
            [0.0, 1.0],
            "Variation",
            "How much radius and pitch vary along a lock and between locks.",
        )
        .unit(Unit::FRACTION),
    ];
}

/// Segments of a strand in one turn.
const SEGMENTS: f32 = 12.0;
/// Turns after which radius and phase have varied once.
const VARIES: [f32; 2] = [3.1, 4.3];

impl Operate for Coil {
    const KIND: Kind = Kind {
        id: "coil",
        label: "Coil",
        text: "Gathers each lock and winds it into a helix, like corkscrew curls.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let plan = Plan { count: u32::MAX, start: 0.0, clear: self.radius.max(0.003) };
        let cords = cords(style, scope, &plan);
        let before = style.guides.clone();
        let onset = self.onset.max(1e-3);
        gather(style, scope, &cords, &Gathering { join: onset, amount: self.gather, tightness: 0.0 });
        // Random numbers of a lock, by its first wisp.
        let segment = self.pitch / SEGMENTS;
        lay(style, &before, scope, &cords, (onset, segment), |cord, _, metres| {
            let mut random = scope.random(1, cord.members[0].wisp);
            let (phase, varies) = (random.angle(), [random.angle(), random.angle()]);
            let hand = if random.unit() < 0.5 { -1.0 } else { 1.0 };
            let turns = metres / self.pitch;
            let wave = |n: usize| (TAU * turns / VARIES[n] + varies[n]).sin() * self.variation;
            let radius = self.radius * (1.0 + 0.3 * wave(0)) * smoothstep(0.0, onset, metres);
            let angle = hand * (TAU * turns + wave(1)) + phase;
            CordPlace { place: Vec2::from_angle(angle) * radius, own: 1.0 - self.gather }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::testing::{acted, places, straight};
    use glam::Vec3;

    #[test]
    fn a_lock_winds_once_in_each_pitch_at_the_radius() {
        let before = straight(Vec3::NEG_Y);
        let coil = Coil { pitch: 0.02, gather: 1.0, variation: 0.0, ..Coil::default() };
        let after = acted(coil.clone(), &before);
        after.check().expect("sound");
        for (w, wisp) in after.wisps.iter().enumerate() {
            let points = places(&after, wisp.first_strand as usize);
            // Beyond the onset: the middle of whole turns is the axis.

            let low = points[points.len() - 1].y + 0.01;
            let turns: Vec<Vec3> =
                points.iter().copied().filter(|p| p.y > low && p.y < low + 4.0 * coil.pitch).collect();
            assert!(turns.len() >= 4 * 10, "{} points", turns.len());
            let axis = turns.iter().sum::<Vec3>() / turns.len() as f32;
            let mut angle = 0.0;
            for pair in turns.windows(2) {
                let [a, b] = [0, 1].map(|k| Vec2::new(pair[k].x - axis.x, pair[k].z - axis.z));
                assert!((0.85..1.15).contains(&(a.length() / coil.radius)), "wisp {w}: {a}");
                angle += a.angle_to(b);
            }
            assert!((angle.abs() / TAU - 4.0).abs() < 0.25, "wisp {w}: {} turns", angle / TAU);
        }
    }
}
