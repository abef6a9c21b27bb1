//! Straightens hair beyond the point where it leaves the head.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::{Bounded, Hairstyle, Obstacle};

use crate::Scope;
use crate::guides::{Lengths, reshape, turn_links};
use crate::operate::{Kind, Operate, Subject};

/// Straightens hair beyond the point where it leaves the head.
#[derive(Clone, Debug, PartialEq)]
pub struct Straighten {
    /// How straight hair becomes, as a fraction.
    pub amount: f32,
    /// Whether it hangs straight down instead of toward its own tip, as a fraction.
    pub drop: f32,
}

impl Default for Straighten {
    fn default() -> Self {
        Self { amount: 0.8, drop: 0.3 }
    }
}

impl Settings for Straighten {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, amount), [0.0, 1.0], "Amount", "How straight hair becomes.")
            .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, drop),
            [0.0, 1.0],
            "Drop",
            "0 % keeps the line to the tip, 100 % hangs straight down.",
        )
        .unit(Unit::FRACTION),
    ];
}

impl Operate for Straighten {
    const KIND: Kind = Kind {
        id: "straighten",
        label: "Straighten",
        text: "Straightens hair beyond the point where it leaves the head.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let body = Bounded(scope.obstacle);
        reshape(style, scope, Lengths::Keep, |shape| {
            let (strength, count) = (shape.strength, shape.points.len());
            // Hair leaves the head where the surface no longer carries it.
            let leaves = |p: &Vec3| {
                let (distance, normal) = body.distance(*p);
                distance > 0.03 || normal.y < 0.15
            };
            let from = shape.points.iter().position(leaves).unwrap_or(count - 1);
            let line = (shape.points[count - 1] - shape.points[from]).normalize_or(Vec3::NEG_Y);
            let target = line.lerp(Vec3::NEG_Y, self.drop).normalize_or(Vec3::NEG_Y);
            turn_links(shape, |i, _, direction| {
                let place = i as f32 / (count - 1) as f32;
                let amount = self.amount * strength * scope.along(place);
                if i < from { direction } else { direction.lerp(target, amount.clamp(0.0, 1.0)) }
            });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::testing::{acted, straight, turn_between};

    #[test]
    fn a_bend_becomes_a_straight_line() {
        let bent = acted(super::super::Bend::default(), &straight(Vec3::NEG_Y));
        let after = acted(Straighten { amount: 1.0, drop: 1.0 }, &bent);
        for g in 0..bent.guides.count() {
            assert!(turn_between(&bent, g) > 1.2);
            assert!(turn_between(&after, g) < 0.02);
        }
    }
}
