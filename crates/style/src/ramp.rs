//! A curve along a strand.

use serde::{Deserialize, Serialize};

/// How a ramp runs between two of its points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RampShape {
    /// Smoothly, without leaving the range of both points.
    #[default]
    Smooth,
    /// Along a straight line.
    Linear,
    /// The value of the point before.
    Steps,
}

/// A function of the place along a strand: 0 is the root, 1 the tip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Ramp {
    /// Place and value of each point, in ascending order of places; the value is constant before the first and after the last.
    pub points: Vec<[f32; 2]>,
    /// How the values between points are found.
    pub shape: RampShape,
}

impl Default for Ramp {
    fn default() -> Self {
        Self::constant(1.0)
    }
}

impl Ramp {
    /// The most points.
    pub const MAX_POINTS: usize = 16;
    /// The range of values.
    pub const RANGE: [f32; 2] = [0.0, 2.0];

    /// The same value everywhere.
    pub fn constant(value: f32) -> Self {
        Self { points: vec![[0.0, value]], shape: RampShape::Smooth }
    }

    /// From one value at the root to another at the tip, in a straight line.
    pub fn line(root: f32, tip: f32) -> Self {
        Self { points: vec![[0.0, root], [1.0, tip]], shape: RampShape::Linear }
    }

    /// Smoothly through these points.
    pub fn through(points: &[[f32; 2]]) -> Self {
        Self { points: points.to_vec(), shape: RampShape::Smooth }
    }

    /// The ramps that editors offer, with their names.
    pub fn presets() -> [(&'static str, Self); 9] {
        [
            ("Constant", Self::constant(1.0)),
            ("Linear", Self::line(0.0, 1.0)),
            ("Linear, falling", Self::line(1.0, 0.0)),
            ("Ease", Self::through(&[[0.0, 0.0], [1.0, 1.0]])),
            ("Ease, falling", Self::through(&[[0.0, 1.0], [1.0, 0.0]])),
            ("Tip", Self::through(&[[0.5, 0.0], [1.0, 1.0]])),
            ("Root", Self::through(&[[0.0, 1.0], [0.5, 0.0]])),
            ("Bell", Self::through(&[[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]])),
            ("Both ends", Self::through(&[[0.0, 1.0], [0.5, 0.0], [1.0, 1.0]])),
        ]
    }

    /// The value at `place`.
    pub fn at(&self, place: f32) -> f32 {
        let points = &self.points;
        let next = points.partition_point(|point| point[0] <= place);
        match (next.checked_sub(1).map(|i| points[i]), points.get(next)) {
            (None, None) => 1.0,
            (Some(only), None) => only[1],
            (None, Some(only)) => only[1],
            (Some(a), Some(b)) => {
                let width = b[0] - a[0];
                let t = (place - a[0]) / width;
                match self.shape {
                    RampShape::Steps => a[1],
                    RampShape::Linear => a[1] + (b[1] - a[1]) * t,
                    RampShape::Smooth => {
                        let (t2, t3) = (t * t, t * t * t);
                        a[1] * (2.0 * t3 - 3.0 * t2 + 1.0)
                            + b[1] * (3.0 * t2 - 2.0 * t3)
                            + width
                                * (self.slope(next - 1) * (t3 - 2.0 * t2 + t) + self.slope(next) * (t3 - t2))
                    }
                }
            }
        }
    }

    /// The slope of the smooth curve at a point: the harmonic mean of the slopes beside it, 0 at extremes, so that the curve is monotone
    /// between points (Fritsch, Butland 1984).
    fn slope(&self, i: usize) -> f32 {
        let points = &self.points;
        if i == 0 || i + 1 >= points.len() {
            return 0.0;
        }
        let chord = |a: [f32; 2], b: [f32; 2]| (b[1] - a[1]) / (b[0] - a[0]);
        let (before, after) = (chord(points[i - 1], points[i]), chord(points[i], points[i + 1]));
        if before * after > 0.0 { 2.0 * before * after / (before + after) } else { 0.0 }
    }

    /// Whether the value is 1 everywhere.
    pub fn is_one(&self) -> bool {
        self.points.iter().all(|point| point[1] == 1.0)
    }

    /// Whether the value is 0 everywhere.
    pub fn is_zero(&self) -> bool {
        !self.points.is_empty() && self.points.iter().all(|point| point[1] == 0.0)
    }

    /// The ramp with its points in order, at distinct places and within the ranges; points that are not finite are left out.
    #[must_use]
    pub fn clamped(&self) -> Self {
        let [low, high] = Self::RANGE;
        let finite = self.points.iter().filter(|point| point.iter().all(|v| v.is_finite()));
        let mut points: Vec<[f32; 2]> =
            finite.map(|&[place, value]| [place.clamp(0.0, 1.0), value.clamp(low, high)]).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        points.dedup_by(|b, a| b[0] - a[0] < 1e-3);
        points.truncate(Self::MAX_POINTS);
        if points.is_empty() {
            points.push([0.0, 1.0]);
        }
        Self { points, shape: self.shape }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_meets_its_points_and_is_constant_beyond_them() {
        let points = [[0.1, 0.5], [0.4, 1.5], [0.9, 0.0]];
        for shape in [RampShape::Smooth, RampShape::Linear, RampShape::Steps] {
            let ramp = Ramp { points: points.to_vec(), shape };
            for [place, value] in points {
                assert!((ramp.at(place) - value).abs() < 1e-6, "{shape:?} at {place}");
            }
            assert_eq!((ramp.at(0.0), ramp.at(1.0)), (0.5, 0.0), "{shape:?}");
        }
        let middle = |shape| Ramp { points: points.to_vec(), shape }.at(0.25);
        assert!((middle(RampShape::Linear) - 1.0).abs() < 1e-6);
        assert_eq!(middle(RampShape::Steps), 0.5);
    }

    #[test]
    fn smooth_ramps_do_not_leave_the_range_of_their_points() {
        let ramp = Ramp::through(&[[0.0, 0.0], [0.1, 0.9], [0.2, 1.0], [0.9, 1.0], [1.0, 0.2]]);
        let values: Vec<f32> = (0..=1000).map(|i| ramp.at(i as f32 / 1000.0)).collect();
        assert!(values.iter().all(|v| (-1e-6..=1.0 + 1e-6).contains(v)));
        // Rising to 0.2, flat to 0.9, falling from there.
        assert!(values[..200].windows(2).all(|pair| pair[1] >= pair[0] - 1e-6));
        assert!(values[200..900].iter().all(|v| (v - 1.0).abs() < 1e-6));
        let steepest = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
        assert!(steepest < 0.02, "no jump: {steepest}");
    }

    #[test]
    fn bad_points_are_brought_into_order() {
        let ramp = Ramp {
            points: vec![[0.8, 9.0], [f32::NAN, 1.0], [0.2, -3.0], [0.2, 0.4], [7.0, 0.5]],
            shape: RampShape::Linear,
        };
        assert_eq!(ramp.clamped().points, [[0.2, 0.0], [0.8, 2.0], [1.0, 0.5]]);
        assert_eq!(Ramp { points: Vec::new(), ..Ramp::default() }.clamped(), Ramp::constant(1.0));
        let many = Ramp { points: (0..100).map(|i| [i as f32 / 100.0, 1.0]).collect(), ..Ramp::default() };
        assert_eq!(many.clamped().points.len(), Ramp::MAX_POINTS);
        assert_eq!(Ramp { points: Vec::new(), ..Ramp::default() }.at(0.5), 1.0);
    }
}
