//! Strokes, and the dabs into which they are divided.

use glam::{Affine3A, Vec3};
use serde::{Deserialize, Serialize};

/// Distance between two dabs as a fraction of the radius.
const SPACING: f32 = 0.2;
/// The least distance between two dabs, metres.
const LEAST_SPACING: f32 = 0.001;
/// The most dabs of one movement; a longer one spreads them.
const MAX_DABS: f32 = 128.0;

/// The brush at one instant of a stroke, world space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StrokeSample {
    /// The place on the hair, metres.
    pub position: Vec3,
    /// Direction of view there.
    pub view: Vec3,
    /// Movement of the brush since the sample before, at the depth of the hair, metres.
    pub drag: Vec3,
    /// Pressure, 0 to 1.
    pub pressure: f32,
    /// The time of the dance, seconds.
    pub time_secs: f64,
}

impl StrokeSample {
    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        [self.position, self.view, self.drag].iter().all(|v| v.is_finite())
            && self.pressure.is_finite()
            && self.time_secs.is_finite()
    }

    /// The sample in another space, such as in the world from the space of the head.
    #[must_use]
    pub fn placed(&self, world_from_own: &Affine3A) -> Self {
        Self {
            position: world_from_own.transform_point3(self.position),
            view: world_from_own.transform_vector3(self.view),
            drag: world_from_own.transform_vector3(self.drag),
            ..*self
        }
    }

    /// The sample carried to the space of the head.
    fn in_head(&self, head_from_world: &Affine3A) -> Self {
        Self {
            position: head_from_world.transform_point3(self.position),
            view: head_from_world.transform_vector3(self.view).normalize_or(Vec3::NEG_Z),
            drag: head_from_world.transform_vector3(self.drag),
            ..*self
        }
    }
}

/// The brush put down once, head space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dab {
    pub centre: Vec3,
    pub radius: f32,
    /// Movement since the dab before, metres; zero for the first of a stroke.
    pub step: Vec3,
    /// Unit direction of view.
    pub view: Vec3,
    pub pressure: f32,
    /// Whether the stroke begins here.
    pub first: bool,
    /// Whether it is on the other side of the head than the brush.
    pub mirrored: bool,
}

impl Dab {
    /// The dab on the other side of the head.
    pub fn mirrored(self) -> Self {
        Self {
            centre: mirror(self.centre),
            step: mirror(self.step),
            view: mirror(self.view),
            mirrored: true,
            ..self
        }
    }
}

/// A place or a direction on the other side of the head.
pub(crate) fn mirror(v: Vec3) -> Vec3 {
    Vec3::new(-v.x, v.y, v.z)
}

/// Divides a stroke into dabs at equal distances along the movement, so that its shape does not depend on how often the pointer is read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Resampler {
    last: Option<StrokeSample>,
    /// Movement since the last dab, and its length along the way.
    carried: Vec3,
    travelled: f32,
}

impl Resampler {
    /// The dabs between the sample before and this one. A sample that is not finite makes none.
    pub fn dabs(&mut self, sample: &StrokeSample, radius: f32, head_from_world: &Affine3A) -> Vec<Dab> {
        if !(sample.is_finite() && radius > 0.0 && radius.is_finite()) {
            return Vec::new();
        }
        let now = sample.in_head(head_from_world);
        let dab = |at: &StrokeSample, step: Vec3, first: bool| Dab {
            centre: at.position,
            radius,
            step,
            view: at.view,
            pressure: at.pressure.clamp(0.0, 1.0),
            first,
            mirrored: false,
        };
        let Some(last) = self.last.replace(now) else { return vec![dab(&now, Vec3::ZERO, true)] };
        let length = now.drag.length();
        let spacing = (SPACING * radius).max(LEAST_SPACING).max(length / MAX_DABS);
        let mut out = Vec::new();
        let mut done = 0.0;
        while length > 0.0 && self.travelled + length - done >= spacing {
            let part = (spacing - self.travelled).max(0.0);
            done += part;
            let t = (done / length).min(1.0);
            let between = StrokeSample {
                position: last.position.lerp(now.position, t),
                view: last.view.lerp(now.view, t).normalize_or(now.view),
                pressure: last.pressure + (now.pressure - last.pressure) * t,
                ..now
            };
            out.push(dab(&between, self.carried + now.drag * (part / length), false));
            (self.carried, self.travelled) = (Vec3::ZERO, 0.0);
        }
        let rest = (length - done).max(0.0);
        if length > 0.0 {
            self.carried += now.drag * (rest / length);
            self.travelled += rest;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dabs(count: usize) -> Vec<Dab> {
        let mut resampler = Resampler::default();
        let at = |i: usize| Vec3::X * (0.2 * i as f32 / count as f32);
        let mut out = Vec::new();
        for i in 0..=count {
            let drag = if i > 0 { at(i) - at(i - 1) } else { Vec3::ZERO };
            let sample =
                StrokeSample { position: at(i), view: Vec3::NEG_Z, drag, pressure: 1.0, time_secs: 0.0 };
            out.extend(resampler.dabs(&sample, 0.03, &Affine3A::IDENTITY));
        }
        out
    }

    #[test]
    fn dabs_do_not_depend_on_the_number_of_samples() {
        let coarse = dabs(3);
        assert_eq!(coarse.len(), 34);
        for count in [10, 100, 1000] {
            let fine = dabs(count);
            // The last dab may be lost to rounding.
            assert!(fine.len().abs_diff(coarse.len()) <= 1, "{}", fine.len());
            for (a, b) in coarse.iter().zip(&fine) {
                assert!(a.centre.distance(b.centre) < 1e-5 && a.step.distance(b.step) < 1e-5, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn strange_samples_make_few_dabs() {
        let mut resampler = Resampler::default();
        let sample = StrokeSample { position: Vec3::ZERO, pressure: 1.0, ..StrokeSample::default() };
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(resampler.dabs(&sample, radius, &Affine3A::IDENTITY).is_empty());
        }
        let bad = StrokeSample { drag: Vec3::NAN, ..sample };
        assert!(resampler.dabs(&bad, 0.1, &Affine3A::IDENTITY).is_empty());
        resampler.dabs(&sample, 0.002, &Affine3A::IDENTITY);
        let far = StrokeSample { drag: Vec3::X * 1e6, ..sample };
        assert!(resampler.dabs(&far, 0.002, &Affine3A::IDENTITY).len() <= 129);
    }
}
