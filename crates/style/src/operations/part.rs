//! Combs hair away from a line along the head.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::guides::{Lengths, comb, reshape, wisp_means};
use crate::operate::{Kind, Operate, Subject};
use crate::scope::{Scope, wisp_roots};

/// Combs hair away from a line along the head.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Place of the line toward the wearer's left, metres from the middle.
    pub position: f32,
    /// Distance from the line within which hair is combed, metres.
    pub width: f32,
    /// Length from the root that is combed, metres.
    pub length: f32,
    /// How far hair turns away from the line, as a fraction.
    pub amount: f32,
}

impl Default for Part {
    fn default() -> Self {
        Self { position: 0.03, width: 0.06, length: 0.1, amount: 0.8 }
    }
}

impl Settings for Part {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, position),
            [-0.08, 0.08],
            "Position",
            "Position of the parting. Positive values are on the wearer's left.",
        )
        .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, width),
            [0.005, 0.2],
            "Reach",
            "Distance from the parting within which hair is combed.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, length),
            [0.01, 0.5],
            "Length",
            "Length from the root over which hair is combed.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, amount),
            [0.0, 1.0],
            "Amount",
            "Angle by which hair turns away from the parting.",
        )
        .unit(Unit::FRACTION),
    ];
}

impl Operate for Part {
    const KIND: Kind = Kind {
        id: "part",
        label: "Part",
        text: "Combs hair away from a parting along the head.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        // A wisp stays on one side; its strands would hang between two.
        let (roots, means) = (wisp_roots(style), wisp_means(style));
        reshape(style, scope, Lengths::Keep, |shape| {
            let root = shape.wisp.map_or(shape.points[0], |wisp| roots[wisp]);
            let aside = root.x - scope.head.middle.x - self.position;
            let near = 1.0 - smoothstep(0.5 * self.width, self.width, aside.abs());
            if near == 0.0 {
                return;
            }
            let toward = Vec3::new(1f32.copysign(aside), -0.4, 0.0).normalize_or(Vec3::NEG_Y);
            comb(shape, scope, &means, toward, self.amount * near, self.length);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::testing::{acted, straight};

    #[test]
    fn hair_near_the_line_goes_away_from_it_on_both_sides() {
        let before = straight(Vec3::NEG_Y);
        let after = acted(Part { position: 0.0, ..Part::default() }, &before);
        let (last, middle) = (before.guides.points_per_guide - 1, crate::HeadBox::of(&before.scalp).middle.x);
        let (roots, wisps) = (wisp_roots(&before), crate::guides::wisp_of_guide(&before));
        let mut sides = [0, 0];
        for g in 0..before.guides.count() {
            let aside = roots[wisps[g].expect("a wisp")].x - middle;
            let moved = after.guides.point(g, last).x - before.guides.point(g, last).x;
            if aside.abs() < 0.03 {
                assert!(moved * aside.signum() > 0.02, "{moved}");
                sides[usize::from(aside > 0.0)] += 1;
            } else if aside.abs() > 0.06 {
                assert!(moved.abs() < 1e-6);
            }
        }
        assert!(sides[0] > 0 && sides[1] > 0);
    }
}
