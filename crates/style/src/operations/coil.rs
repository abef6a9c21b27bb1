//! Gathers each lock and winds it in a helix, as dreadlocks.

use crate::guides::{Lengths, frames, reshape, wisp_means};
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;
use std::f32::consts::TAU;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// Gathers each lock and winds it in a helix, as dreadlocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Coil {
    /// Radius of the helix, metres.
    pub radius: f32,
    /// Length of one turn, metres.
    pub pitch: f32,
    /// How far the guides of a lock come together, as a fraction.
    pub gather: f32,
    /// Distance from the root over which locks gather, metres.
    pub onset: f32,
}

impl Default for Coil {
    fn default() -> Self {
        Self { radius: 0.006, pitch: 0.06, gather: 0.8, onset: 0.04 }
    }
}

impl Settings for Coil {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, radius), [0.0, 0.04], "Radius", "Radius of the coils.")
            .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, pitch),
            [0.02, 0.4],
            "Pitch",
            "Length of one turn. Hair with few control points coils less tightly.",
        )
        .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, gather),
            [0.0, 1.0],
            "Gather",
            "How far the hair of a lock comes together.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, onset),
            [0.0, 0.3],
            "Onset",
            "Length of hair from the root over which locks gather.",
        )
        .unit(Unit::METRES_AS_CM),
    ];
}

impl Operate for Coil {
    const KIND: Kind = Kind {
        id: "coil",
        label: "Coil",
        text: "Gathers each lock and winds it in a helix, as dreadlocks.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let means = wisp_means(style);
        reshape(style, scope, Lengths::Keep, |shape| {
            let Some((wisp, mean)) = shape.wisp.map(|wisp| (wisp, &means[wisp])) else { return };
            let frames = frames(mean, shape.points[0] - scope.head.middle);
            let phase = scope.random(0, wisp).angle();
            // A turn has three links at least.
            let pitch = self.pitch.max(3.0 * shape.link);
            for i in 1..shape.points.len() {
                let metres = i as f32 * shape.link;
                let onset = smoothstep(0.0, self.onset.max(1e-3), metres);
                let strength = shape.strength * scope.along(shape.place(i));
                let angle = TAU * metres / pitch + phase;
                let helix = (frames[i].0 * angle.cos() + frames[i].1 * angle.sin()) * self.radius;
                let target = mean[i] + (shape.points[i] - mean[i]) * (1.0 - self.gather) + helix;
                shape.points[i] = shape.points[i].lerp(target, (onset * strength).clamp(0.0, 1.0));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::operations::testing::{acted, straight};

    #[test]
    fn a_lock_gathers_and_keeps_the_radius_of_the_helix() {
        let before = straight(Vec3::NEG_Y);
        let coil = Coil { gather: 1.0, ..Coil::default() };
        let after = acted(coil.clone(), &before);
        let means = wisp_means(&before);
        for (w, wisp) in before.wisps.iter().enumerate() {
            let tip = |g: u32| after.guides.point(g as usize, 20);
            let apart = tip(wisp.guides[0]).distance(tip(wisp.guides[1]));
            let was = before
                .guides
                .point(wisp.guides[0] as usize, 20)
                .distance(before.guides.point(wisp.guides[1] as usize, 20));
            assert!(apart < was, "{apart} {was}");
            for g in wisp.guides {
                let away = (tip(g) - means[w][20]) * Vec3::new(1.0, 0.0, 1.0);
                assert!((0.5..1.3).contains(&(away.length() / coil.radius)), "{away}");
            }
        }
    }
}
