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
            "How far the direction rises. Below 0° it falls.",
        )
        .unit(Unit::RADIANS),
        Setting::number(field!(Self, amount), [0.0, 1.0], "Amount", "How far hair turns to the direction.")
            .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, length),
            [0.01, 1.5],
            "Length",
            "Length of hair from the root that is combed.",
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
    use lovelock_groom::{GroomSettings, PlainHead, Wisp, grow};

    use super::*;
    use crate::operations::testing::{acted, straight};
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

    /// Hair on the plain head that is combed straight against its growth.
    fn combed_back(amount: f32) -> Hairstyle {
        let settings =
            GroomSettings { wisps: 80, strands_per_wisp: 3, sweep: -1.0, ..GroomSettings::default() };
        let style = grow(&settings, &PlainHead.scalp(24), &PlainHead).expect("hair");
        let sweep = Sweep { azimuth: 3.14, elevation: 0.0, amount, length: 0.2 };
        apply_layer(&Layer::of(sweep), 1.0, &style, &PlainHead).unwrap_or(style)
    }

    /// The largest distance between guides of one wisp at a point, relative to that at their roots, over the wisps.
    fn apart(style: &Hairstyle, point: usize) -> f32 {
        let spread = |wisp: &Wisp, point: usize| {
            let [a, b, c] = wisp.guides.map(|g| style.guides.point(g as usize, point));
            a.distance(b).max(b.distance(c)).max(c.distance(a))
        };
        style.wisps.iter().map(|wisp| spread(wisp, point) / spread(wisp, 0)).fold(0.0, f32::max)
    }

    #[test]
    fn a_wisp_that_is_combed_against_its_growth_turns_to_one_side() {
        let (before, after) = (combed_back(0.0), combed_back(0.9));
        assert!(apart(&before, 10) < 3.0, "{}", apart(&before, 10));
        assert!(apart(&after, 10) < 4.0, "{}", apart(&after, 10));
    }
}
