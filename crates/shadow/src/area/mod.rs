//! Lights that are not points: their shadows have soft edges.
//!
//! A directional light shines from a disc of directions, a light that stands somewhere from a disc that faces the hair. The disc is
//! divided into parts of one area, and the light is the mean of as many lights, one in the middle of each part. Every method builds a
//! map for each of them, below all methods: see [`SoftMap`].

mod gpu;
mod map;

pub(crate) use gpu::{GpuSoftMaps, average_shaders};
pub(crate) use map::SoftMap;

use glam::{Vec2, Vec3};

use crate::{LightFrame, LightSource};

/// The area from which light comes, and how it is sampled. The radius of a light that stands somewhere is that of its
/// [`LightSource`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightArea {
    /// Angle between the middle and the edge of a directional light, radians, at most [`LightArea::MAX_ANGLE`].
    pub angle: f32,
    /// Samples of the light, each with a map: 1 for hard shadows, at most [`LightArea::MAX_SAMPLES`].
    pub samples: u32,
}

impl LightArea {
    /// A light whose shadows are hard.
    pub const HARD: Self = Self { angle: 0.0, samples: 1 };
    /// The most samples of a light.
    pub const MAX_SAMPLES: u32 = 64;
    /// The largest angle, radians.
    pub const MAX_ANGLE: f32 = 1.0;

    /// Samples in their range.
    fn safe_samples(self) -> u32 {
        self.samples.clamp(1, Self::MAX_SAMPLES)
    }

    /// The radius of a directional light on a plane one metre away.
    pub(crate) fn tangent(self) -> f32 {
        if self.angle > 0.0 { self.angle.min(Self::MAX_ANGLE).tan() } else { 0.0 }
    }
}

/// Point `i` of `count` in the unit disc: a spiral whose parts have one area (Vogel 1979, "A better way to construct the sunflower
/// head"). The first one is the middle.
fn disc_point(i: u32, count: u32) -> Vec2 {
    /// The golden angle.
    const TURN: f32 = 2.399_963_1;
    if i == 0 {
        return Vec2::ZERO;
    }
    let radius = ((i as f32 + 0.5) / count as f32).sqrt();
    radius * Vec2::from_angle(i as f32 * TURN)
}

impl LightFrame {
    /// Lights whose mean this light is, around hair at `anchor`: the first one is its middle. One if shadows are hard.
    pub fn samples(&self, anchor: Vec3) -> Vec<Self> {
        self.sampled(anchor, self.area.safe_samples())
    }

    /// The same with another number of samples.
    pub(crate) fn sampled(&self, anchor: Vec3, count: u32) -> Vec<Self> {
        let hard = Self { area: LightArea::HARD, ..*self };
        let sample = |i: u32| {
            let at = disc_point(i, count);
            let across = |radius: f32| radius * (at.x * self.y + at.y * self.z);
            if at == Vec2::ZERO {
                return hard;
            }
            match self.source {
                None => hard.transported(self.x + across(self.area.tangent())),
                Some(source) => {
                    let position = source.position + across(source.safe_radius());
                    hard.transported(anchor - position).with_source(LightSource { position, ..source })
                }
            }
        };
        (0..count.max(1)).map(sample).collect()
    }

    /// The same axes of a light at another place.
    fn with_source(self, source: LightSource) -> Self {
        Self { source: Some(source), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_the_disc_are_spread_evenly() {
        for count in [16, 32, 64] {
            let points: Vec<_> = (0..count).map(|i| disc_point(i, count)).collect();
            // On paper the mean of the square of the radius is 1/2, and that of each coordinate 0 and its square 1/4.
            let mean = |of: &dyn Fn(Vec2) -> f32| points.iter().map(|p| of(*p)).sum::<f32>() / count as f32;
            let near = 1.5 / count as f32;
            assert!((mean(&|p| p.length_squared()) - 0.5).abs() < near, "{count}");
            assert!(mean(&|p| p.x).abs() < near && mean(&|p| p.y).abs() < near, "{count}");
            assert!((mean(&|p| p.x * p.x) - 0.25).abs() < near, "{count}");
            assert!(points.iter().all(|p| p.length() <= 1.0));
        }
        assert_eq!(disc_point(0, 16), Vec2::ZERO);
    }

    #[test]
    fn a_hard_light_is_its_only_sample() {
        let light = LightFrame::new(Vec3::new(0.3, -1.0, 0.2));
        let soft = LightFrame { area: LightArea { angle: 0.1, samples: 9 }, ..light };
        assert_eq!(light.samples(Vec3::ZERO), [light]);
        assert_eq!(soft.samples(Vec3::ZERO).len(), 9);
        assert_eq!(soft.samples(Vec3::ZERO)[0], light);
        let many = LightFrame { area: LightArea { angle: f32::NAN, samples: u32::MAX }, ..light };
        assert_eq!(many.samples(Vec3::ZERO).len(), LightArea::MAX_SAMPLES as usize);
        let none = LightFrame { area: LightArea { angle: 0.1, samples: 0 }, ..light };
        assert_eq!(none.samples(Vec3::ZERO), [light]);
    }

    #[test]
    fn samples_lie_within_the_angle_and_the_radius() {
        let light = LightFrame::new(Vec3::new(0.3, -1.0, 0.2));
        let sun = LightFrame { area: LightArea { angle: 0.1, samples: 32 }, ..light };
        let angles: Vec<_> =
            sun.samples(Vec3::ZERO).iter().map(|s| s.x.dot(light.x).clamp(-1.0, 1.0).acos()).collect();
        assert!(angles.iter().all(|a| *a < 0.1) && angles.iter().any(|a| *a > 0.09), "{angles:?}");
        let anchor = Vec3::new(0.0, 1.6, 0.0);
        let source = LightSource { position: anchor + Vec3::new(0.0, 2.0, 0.0), radius: 0.2 };
        let lamp = light.standing(source, anchor);
        let lamp = LightFrame { area: LightArea { angle: 0.0, samples: 32 }, ..lamp };
        for sample in lamp.samples(anchor) {
            let at = sample.source.expect("it stands").position;
            assert!((at.y - source.position.y).abs() < 1e-6 && at.distance(source.position) < 0.2);
            assert!((sample.x - (anchor - at).normalize_or_zero()).length() < 1e-6, "it faces the hair");
        }
    }
}
