//! Bends the ends of hair under or out.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::guides::{Lengths, reshape, turn_links, turned};
use crate::operate::{Kind, Operate, Subject};

/// Bends the ends of hair under or out.
#[derive(Clone, Debug, PartialEq)]
pub struct Bend {
    /// How far ends turn: under above 0, out below, radians.
    pub angle: f32,
    /// Length from the tip over which hair bends, metres.
    pub length: f32,
}

impl Default for Bend {
    fn default() -> Self {
        Self { angle: 1.5, length: 0.08 }
    }
}

impl Settings for Bend {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, angle),
            [-3.1, 3.1],
            "Angle",
            "Angle by which the ends turn: positive values turn them under, negative ones out.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, length),
            [0.005, 0.5],
            "Length",
            "Length of hair from the tip that bends.",
        )
        .unit(Unit::METRES_AS_CM),
    ];
}

impl Operate for Bend {
    const KIND: Kind = Kind {
        id: "bend",
        label: "Bend",
        text: "Bends the ends of hair under or out.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        reshape(style, scope, Lengths::Keep, |shape| {
            let (link, strength, count) = (shape.link, shape.strength, shape.points.len());
            let start = (shape.length() - self.length).max(0.0);
            let bent = shape.length() - start;
            let from = (start / link) as usize;
            // Toward the head at the height of the bend.
            let mut inward = scope.head.middle - shape.points[from.min(count - 1)];
            inward.y = 0.0;
            let inward = inward.normalize_or(Vec3::NEG_Z);
            turn_links(shape, |i, _, direction| {
                let part = (((i + 1) as f32 * link - start) / bent).clamp(0.0, 1.0);
                let place = (i + 1) as f32 / (count - 1) as f32;
                turned(direction, inward, self.angle * part * strength * scope.along(place), true)
            });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::testing::{acted, straight, turn_between};

    #[test]
    fn ends_turn_under_or_out_by_the_angle() {
        let before = straight(Vec3::NEG_Y);
        let last = before.guides.points_per_guide - 1;
        let middle = crate::HeadBox::of(&before.scalp).middle;
        for angle in [1.2, -1.2] {
            let after = acted(Bend { angle, ..Bend::default() }, &before);
            for g in 0..before.guides.count() {
                let turn = turn_between(&after, g);
                assert!((turn - 1.2).abs() < 0.15, "{turn}");
                let moved = after.guides.point(g, last) - before.guides.point(g, last);
                let inward = (middle - before.guides.point(g, 0)) * Vec3::new(1.0, 0.0, 1.0);
                assert!(moved.dot(inward) * angle > 0.0);
            }
        }
    }
}
