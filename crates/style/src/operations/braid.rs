//! Gathers hair beyond a distance into three bundles that weave.

use crate::guides::{GuideShape, Lengths, frames, reshape, shape_of, wisp_means, wisp_of_guide};
use glam::Vec3;
use lovelock_base::field;
use lovelock_base::numbers::smoothstep;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_groom::Hairstyle;
use lovelock_groom::polyline::sample;
use std::f32::consts::TAU;

use crate::Scope;
use crate::operate::{Kind, Operate, Subject};

/// Gathers hair beyond a distance into three bundles that weave.
#[derive(Clone, Debug, PartialEq)]
pub struct Braid {
    /// Distance from the root at which the braid begins, metres.
    pub start: f32,
    /// How far bundles swing to each side, metres.
    pub width: f32,
    /// Length over which a bundle crosses and returns, metres.
    pub pitch: f32,
    /// How thin bundles are, as a fraction.
    pub tightness: f32,
}

impl Default for Braid {
    fn default() -> Self {
        Self { start: 0.15, width: 0.018, pitch: 0.1, tightness: 0.6 }
    }
}

impl Settings for Braid {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::number(field!(Self, start), [0.01, 1.0], "Start", "Length of hair before the braid begins.")
            .unit(Unit::METRES_AS_CM),
        Setting::number(field!(Self, width), [0.003, 0.06], "Width", "How far bundles swing to each side.")
            .unit(Unit::METRES_AS_MM),
        Setting::number(
            field!(Self, pitch),
            [0.03, 0.4],
            "Pitch",
            "Length over which a bundle crosses and returns.",
        )
        .unit(Unit::METRES_AS_CM),
        Setting::number(
            field!(Self, tightness),
            [0.0, 1.0],
            "Tightness",
            "How tightly bundles are gathered.",
        )
        .unit(Unit::FRACTION),
    ];
}

/// Distance between points of the axis, metres.
const STEP: f32 = 0.01;

/// The middle of a braid.
struct Axis {
    /// Points [`STEP`] apart.
    middle: Vec<Vec3>,
    /// Directions to the side and in depth at each.
    frames: Vec<(Vec3, Vec3)>,
    /// The bundle of each wisp; none for those without a braid.
    bundle: Vec<Option<usize>>,
}

impl Axis {
    /// The middle and its two directions at a distance from the start.
    fn at(&self, metres: f32) -> (Vec3, Vec3, Vec3) {
        let at = metres / STEP;
        let frame = self.frames[(at as usize).min(self.frames.len() - 1)];
        (sample(&self.middle, at), frame.0, frame.1)
    }
}

impl Braid {
    /// The axis of the braid; `None` if no hair is long enough.
    fn axis(&self, style: &Hairstyle, scope: &Scope<'_>) -> Option<Axis> {
        let wisp_of = wisp_of_guide(style);
        let strengths = scope.guides(style);
        let long: Vec<GuideShape> = (0..style.guides.count())
            .filter(|&g| strengths[g] > 0.0 && wisp_of[g].is_some())
            .filter_map(|g| shape_of(&style.guides, g, strengths[g], wisp_of[g]))
            .filter(|shape| shape.length() > self.start)
            .collect();
        let point = |shape: &GuideShape, metres: f32| sample(&shape.points, metres / shape.link);
        let longest = long.iter().map(GuideShape::length).reduce(f32::max)?;
        let start = long.iter().map(|shape| point(shape, self.start)).sum::<Vec3>() / long.len() as f32;
        let root = long.iter().map(|shape| shape.points[0]).sum::<Vec3>() / long.len() as f32;
        let mut middle = vec![start];
        let mut direction = Vec3::NEG_Y;
        for i in 0..((longest - self.start) / STEP).ceil() as usize {
            let from = self.start + i as f32 * STEP;
            let there = long.iter().filter(|shape| shape.length() >= from + STEP);
            let sum: Vec3 = there.map(|shape| point(shape, from + STEP) - point(shape, from)).sum();
            direction = sum.normalize_or(direction);
            middle.push(middle[i] + direction * STEP);
        }
        let frames = frames(&middle, start - scope.head.middle);
        // Roots by their angle about the axis, a third in each bundle.
        let means = wisp_means(style);
        let mut wisps: Vec<usize> = long.iter().filter_map(|shape| shape.wisp).collect();
        wisps.sort_unstable();
        wisps.dedup();
        let angle = |wisp: usize| {
            let from = means[wisp][0] - root;
            from.dot(frames[0].1).atan2(from.dot(frames[0].0))
        };
        wisps.sort_by(|a, b| angle(*a).total_cmp(&angle(*b)));
        let mut bundle = vec![None; style.wisps.len()];
        for (rank, wisp) in wisps.iter().enumerate() {
            bundle[*wisp] = Some(rank * 3 / wisps.len());
        }
        Some(Axis { middle, frames, bundle })
    }
}

impl Operate for Braid {
    const KIND: Kind = Kind {
        id: "braid",
        label: "Braid",
        text: "Gathers hair beyond a distance into three bundles that weave.",
        subject: Subject::Shape,
    };

    fn apply(&self, style: &mut Hairstyle, scope: &Scope<'_>) {
        let Some(braid) = self.axis(style, scope) else { return };
        reshape(style, scope, Lengths::Keep, |shape| {
            let Some(bundle) = shape.wisp.and_then(|wisp| braid.bundle[wisp]) else { return };
            if shape.length() <= self.start {
                return;
            }
            let phase = TAU * bundle as f32 / 3.0;
            let mut random = scope.random(0, shape.index);
            let (angle, radius) = (random.angle(), random.unit().sqrt());
            // Bundles are as thick as the braid has room for.
            let thick = self.width * (0.6 - 0.5 * self.tightness) * radius;
            for i in 1..shape.points.len() {
                let beyond = i as f32 * shape.link - self.start;
                if beyond <= 0.0 {
                    continue;
                }
                let (middle, across, deep) = braid.at(beyond);
                let turn = TAU * beyond / self.pitch.max(6.0 * shape.link) + phase;
                let x = self.width * turn.sin() + thick * angle.cos();
                let y = 0.5 * self.width * (2.0 * turn).sin() + thick * angle.sin();
                let target = middle + across * x + deep * y;
                let strength = shape.strength * scope.along(shape.place(i));
                let amount = smoothstep(0.0, 0.5 * self.pitch, beyond) * strength;
                shape.points[i] = shape.points[i].lerp(target, amount.clamp(0.0, 1.0));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operations::testing::{acted, straight};

    #[test]
    fn hair_gathers_in_three_bundles_that_change_sides() {
        let before = straight(Vec3::NEG_Y);
        let braid = Braid { start: 0.05, tightness: 1.0, ..Braid::default() };
        let after = acted(braid.clone(), &before);
        let guides = &after.guides;
        let tall = |i: usize| {
            let points: Vec<Vec3> = (0..guides.count()).map(|g| guides.point(g, i)).collect();
            points.iter().map(|p| (*p * Vec3::new(1.0, 0.0, 1.0)).length()).fold(0.0, f32::max)
        };
        assert!(tall(guides.points_per_guide - 1) < 0.9 * tall(0));
        let scope = Scope {
            obstacle: &lovelock_groom::NoObstacle,
            head: crate::HeadBox::of(&before.scalp),
            weight: 1.0,
            mask: &crate::Mask::default(),
            ramp: &crate::Ramp::default(),
            seed: 0,
        };
        let axis = braid.axis(&before, &scope).expect("an axis");
        let mut counts = [0; 3];
        axis.bundle.iter().flatten().for_each(|&b| counts[b] += 1);
        assert_eq!(counts, [4, 4, 4]);
        // Each guide crosses the middle of the braid.
        let across = axis.at(0.0).1;
        for g in 0..guides.count() {
            let sides = (12..guides.points_per_guide).map(|i| {
                let p = guides.point(g, i);
                (p - axis.middle[0]).dot(across)
            });
            let (low, high) = sides.fold((f32::MAX, f32::MIN), |(l, h), x| (l.min(x), h.max(x)));
            assert!(low < -0.005 && high > 0.005 && high - low < 0.12, "{low} {high}");
        }
    }
}
