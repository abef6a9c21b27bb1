//! Lifts hair at its roots for more volume.

use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::{Bounded, Hairstyle, Obstacle};

use crate::Scope;
use crate::guides::{Lengths, reshape, turn_links, turned};
use crate::operate::{Kind, Operate, Subject};

/// Lifts hair at its roots for more volume.
#[derive(Clone, Debug, PartialEq)]
pub struct Lift {
    /// How far roots are raised away from the scalp, radians.
    pub angle: f32,
    /// Distance from the root over which hair is raised, metres.
    pub distance: f32,
}

impl Default for Lift {
    fn default() -> Self {
        Self { angle: 0.5, distance: 0.05 }
    }
}

impl Settings for Lift {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, angle),
            [0.0, 1.6],
            "Angle",
            "How far hair lifts off the scalp. Higher values add volume.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, distance),
            [0.005, 0.3],
            "Distance",
            "Length from the root over which hair is lifted.",
        )
        .unit(Unit::METRES_AS_CM),
    ];
}

impl Operate for Lift {
    const KIND: Kind = Kind {
        id: "lift",
        label: "Lift",
        text: "Lifts hair at its roots for more volume.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let body = Bounded(scope.obstacle);
        reshape(style, scope, Lengths::Keep, |shape| {
            let root = shape.points[0];
            let (distance, normal) = body.distance(root);
            // Far from any body, away from the middle of the head.
            let away = (root - scope.head.middle).normalize_or(normal);
            let outward = if distance.abs() < 0.05 { normal } else { away };
            let (link, strength, count) = (shape.link, shape.strength, shape.points.len());
            turn_links(shape, |i, _, direction| {
                let fade = 1.0 - smoothstep(0.0, self.distance, i as f32 * link);
                let place = i as f32 / (count - 1) as f32;
                turned(direction, outward, self.angle * fade * strength * scope.along(place), false)
            });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::testing::{acted, straight, turn_between};
    use glam::Vec3;

    #[test]
    fn roots_turn_away_from_the_scalp_and_ends_keep_their_direction() {
        let before = straight(Vec3::NEG_Y);
        let after = acted(Lift::default(), &before);
        let middle = crate::HeadBox::of(&before.scalp).middle;
        let last = before.guides.points_per_guide - 1;
        for g in 0..before.guides.count() {
            let out = (before.guides.point(g, 0) - middle).normalize_or_zero();
            let rise = (after.guides.point(g, last) - before.guides.point(g, last)).dot(out);
            assert!(rise > 0.003, "{rise}");
            let turn = turn_between(&after, g);
            assert!((0.35..0.55).contains(&turn), "{turn}");
        }
    }
}
