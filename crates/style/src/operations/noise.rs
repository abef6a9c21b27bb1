//! Bends locks irregularly.

use crate::guides::{Lengths, reshape};
use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// Bends locks irregularly.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// How far hair leaves its course, metres.
    pub amplitude: f32,
    /// Length between bends, metres.
    pub wavelength: f32,
    /// How much the guides of a lock differ, as a fraction.
    pub apart: f32,
}

impl Default for Noise {
    fn default() -> Self {
        Self { amplitude: 0.008, wavelength: 0.06, apart: 0.2 }
    }
}

impl Settings for Noise {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, amplitude),
            [0.0, 0.05],
            "Amplitude",
            "How far hair is moved from its path.",
        )
        .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, wavelength),
            [0.01, 0.5],
            "Wavelength",
            "Length of hair between two bends.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, apart),
            [0.0, 1.0],
            "Within locks",
            "How much strands of one lock differ. Higher values open the locks.",
        )
        .unit(Unit::FRACTION),
    ];
}

impl Operate for Noise {
    const KIND: Kind =
        Kind { id: "noise", label: "Noise", text: "Bends locks irregularly.", subject: Subject::Shape };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        reshape(style, scope, Lengths::Keep, |shape| {
            let knots = (shape.length() / self.wavelength.max(0.005)) as usize + 2;
            let mut of_lock = scope.random(0, shape.wisp.unwrap_or(shape.index));
            let mut of_guide = scope.random(1, shape.index);
            let values: Vec<Vec3> = (0..knots)
                .map(|_| {
                    let mut vector = |own: f32| {
                        let random = if own > 0.0 { &mut of_guide } else { &mut of_lock };
                        Vec3::new(random.signed(), random.signed(), random.signed())
                    };
                    vector(0.0).lerp(vector(1.0), self.apart)
                })
                .collect();
            let directions: Vec<_> = (0..shape.points.len()).map(|i| shape.direction(i)).collect();
            for (i, direction) in directions.iter().enumerate().skip(1) {
                let metres = i as f32 * shape.link;
                let at = metres / self.wavelength.max(0.005);
                let knot = (at as usize).min(knots - 2);
                let swing = values[knot].lerp(values[knot + 1], smoothstep(0.0, 1.0, at - knot as f32));
                let across = swing.reject_from_normalized(*direction);
                let onset = smoothstep(0.0, self.wavelength, metres);
                let strength = shape.strength * scope.along(shape.place(i));
                shape.points[i] += across * (self.amplitude * onset * strength);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::testing::{acted, straight};

    #[test]
    fn straight_hair_leaves_its_line_by_no_more_than_the_amplitude() {
        let before = straight(Vec3::NEG_Y);
        let after = acted(Noise { amplitude: 0.01, ..Noise::default() }, &before);
        for g in 0..before.guides.count() {
            let root = before.guides.point(g, 0);
            let away = |i| ((after.guides.point(g, i) - root) * Vec3::new(1.0, 0.0, 1.0)).length();
            let most = (0..before.guides.points_per_guide).map(away).fold(0.0, f32::max);
            assert!((0.001..0.0175).contains(&most), "{most}");
        }
    }
}
