//! Combs hair over the scalp in one direction.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::guides::{Lengths, comb, reshape, wisp_means};
use crate::operate::{Kind, Operate, Subject};

/// Combs hair over the scalp in one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Direction about the head: 0 is forward, a quarter turn the wearer's left, radians.
    pub azimuth: f32,
    /// How far the direction rises, radians.
    pub elevation: f32,
    /// How far hair turns to the direction, as a fraction.
    pub amount: f32,
    /// Length from the root that is combed, metres.
    pub length: f32,
}

impl Default for Sweep {
    fn default() -> Self {
        Self { azimuth: 1.57, elevation: -0.3, amount: 0.7, length: 0.15 }
    }
}

impl Settings for Sweep {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, azimuth),
            [-3.15, 3.15],
            "Azimuth",
            "Direction about the head: 0° is forward, 90° the wearer's left, 180° back.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, elevation),
            [-1.57, 1.57],
            "Elevation",
            "Angle of the direction above the horizontal. Negative values point down.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, amount),
            [0.0, 1.0],
            "Amount",
            "How far hair turns toward the direction.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, length),
            [0.01, 1.5],
            "Length",
            "Length from the root over which hair is combed.",
        )
        .unit(Unit::METRES_AS_CM),
    ];
}

impl Operate for Sweep {
    const KIND: Kind = Kind {
        id: "sweep",
        label: "Sweep",
        text: "Combs hair over the scalp in one direction.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let (sin, cos) = self.azimuth.sin_cos();
        let level = Vec3::new(sin, 0.0, cos) * self.elevation.cos();
        let toward = level + Vec3::Y * self.elevation.sin();
        let means = wisp_means(style);
        reshape(style, scope, Lengths::Keep, |shape| {
            comb(shape, scope, &means, toward, self.amount, self.length);
        });
    }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::{Obstacle, PlainHead};

    use super::*;
    use crate::operations::testing::{acted, direction, straight};
    use crate::scope::wisp_roots;
    use crate::{Layer, apply_layer};

    #[test]
    fn hair_turns_to_the_direction() {
        let before = straight(Vec3::NEG_Y);
        let after = acted(Sweep { amount: 1.0, length: 1.5, elevation: 0.0, ..Sweep::default() }, &before);
        let last = before.guides.points_per_guide - 1;
        for g in 0..before.guides.count() {
            let way = after.guides.point(g, last) - after.guides.point(g, 0);
            assert!(way.distance(Vec3::X * 0.31) < 0.01, "{way}");
        }
    }

    #[test]
    fn the_guides_of_a_wisp_turn_to_the_same_side_against_their_growth() {
        let mut style = straight(Vec3::NEG_X);
        let per = style.guides.points_per_guide;
        for wisp in &style.wisps {
            for (guide, lean) in wisp.guides.into_iter().zip([0.1, -0.1, 0.04]) {
                for i in 1..per {
                    style.guides.z[guide as usize * per + i] += lean * 0.31 * i as f32 / (per - 1) as f32;
                }
            }
        }
        let half = Sweep { azimuth: 1.57, elevation: 0.0, amount: 0.5, length: 1.0 };
        let after = apply_layer(&Layer::of(half), 1.0, &style, &PlainHead).expect("a change");
        let roots = wisp_roots(&style);
        let on_top = (0..style.wisps.len()).filter(|wisp| PlainHead.distance(roots[*wisp]).1.y > 0.8);
        let widest = on_top.map(|wisp| {
            let [a, b, c] = style.wisps[wisp].guides.map(|g| direction(&after, g as usize, 0));
            a.angle_between(b).max(b.angle_between(c)).max(c.angle_between(a))
        });
        let widest: Vec<f32> = widest.collect();
        assert!(!widest.is_empty() && widest.iter().all(|angle| *angle < 1.8), "{widest:?}");
    }
}
