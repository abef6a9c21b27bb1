//! Smooths bends in the hair and differences between neighbouring locks.

use crate::guides::{GuideShape, Lengths, reshape, shape_of};
use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;
use lovelock_groom::polyline::sample;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// Neighbours of a guide.
const NEIGHBOURS: usize = 6;
/// The part of the length at which the direction of combed hair is taken.
const COMBED: f32 = 0.2;
/// Passes of the smoothing along hair.
const PASSES: usize = 8;

/// Smooths bends in the hair and differences between neighbouring locks.
#[derive(Clone, Debug, PartialEq)]
pub struct Smooth {
    /// How much bends along the hair are smoothed, as a fraction.
    pub along: f32,
    /// How much neighbouring hair becomes alike, as a fraction.
    pub between: f32,
}

impl Default for Smooth {
    fn default() -> Self {
        Self { along: 0.6, between: 0.4 }
    }
}

impl Settings for Smooth {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(
            field!(Self, along),
            [0.0, 1.0],
            "Bends",
            "How strongly bends along the hair are smoothed.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, between),
            [0.0, 1.0],
            "Between locks",
            "How strongly hair aligns with its neighbours.",
        )
        .unit(Unit::FRACTION),
    ];
}

impl Operate for Smooth {
    const KIND: Kind = Kind {
        id: "smooth",
        label: "Smooth",
        text: "Smooths bends in the hair and differences between neighbouring locks.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let all: Vec<_> = (0..style.guides.count()).map(|g| shape_of(&style.guides, g, 1.0, None)).collect();
        reshape(style, scope, Lengths::Keep, |shape| {
            let before = shape.points.clone();
            let (count, length) = (before.len(), shape.length());
            // Hair parts near its roots; further down all of it falls the same way.
            let own = sample(&before, COMBED * (count - 1) as f32) - before[0];
            let mut near: Vec<(f32, &GuideShape)> = all
                .iter()
                .flatten()
                .filter(|other| other.index != shape.index)
                .map(|other| (other.points[0].distance_squared(before[0]), other))
                .collect();
            if near.len() > NEIGHBOURS {
                near.select_nth_unstable_by(NEIGHBOURS, |a, b| a.0.total_cmp(&b.0));
                near.truncate(NEIGHBOURS);
            }
            let mut points = before.clone();
            for (i, point) in points.iter_mut().enumerate().skip(1) {
                let place = i as f32 / (count - 1) as f32;
                let (mut sum, mut weight) = (before[i] - before[0], 1.0);
                for (_, other) in &near {
                    let last = other.points.len() - 1;
                    let way = sample(&other.points, COMBED * last as f32) - other.points[0];
                    // Hair that goes another way, as across a parting, counts less.
                    let alike = way.normalize_or_zero().dot(own.normalize_or_zero()).max(0.0).powi(6);
                    let offset = sample(&other.points, place * last as f32) - other.points[0];
                    sum += offset * (alike * length / other.length());
                    weight += alike;
                }
                *point = before[i].lerp(before[0] + sum / weight, self.between);
            }
            for _ in 0..PASSES {
                let old = points.clone();
                for i in 1..count - 1 {
                    points[i] = old[i].lerp(0.5 * (old[i - 1] + old[i + 1]), 0.5 * self.along);
                }
            }
            for i in 1..count {
                let strength = (shape.strength * scope.along(shape.place(i))).clamp(0.0, 1.0);
                shape.points[i] = before[i].lerp(points[i], strength);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::testing::{acted, direction, straight};

    /// Sum of the angles between links.
    fn bends(style: &Hairstyle, guide: usize) -> f32 {
        let links = style.guides.points_per_guide - 1;
        (1..links).map(|i| direction(style, guide, i - 1).angle_between(direction(style, guide, i))).sum()
    }

    #[test]
    fn waves_become_flatter() {
        let wave = super::super::Wave { length: 0.05, ..Default::default() };
        let waved = acted(wave, &straight(glam::Vec3::NEG_Y));
        let after = acted(Smooth { along: 1.0, between: 0.0 }, &waved);
        for g in 0..waved.guides.count() {
            assert!(bends(&after, g) < 0.6 * bends(&waved, g), "{} {}", bends(&after, g), bends(&waved, g));
        }
    }
}
