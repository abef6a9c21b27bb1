//! The weights of a wisp's strands, bounded by a polygon in the plane of weights that sum to 1.

use crate::{StrandSet, Wisp};

use super::strands_of;

/// A rectangle cut by two parallel lines has at most six corners; eight fill a vector.
pub(super) const CORNERS: usize = 8;
/// How much the polygon is enlarged, as a fraction of the largest weight.
const ROUNDING: f32 = 1e-6;

/// Contains the weights of all strands of a wisp: each of the three weights lies between its smallest and largest
/// value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Polygon {
    /// Weights that sum to 1; the last corner is repeated if there are fewer.
    pub corners: [[f32; 3]; CORNERS],
    /// Largest sum of the absolute weights of a corner.
    pub sum: f32,
    /// The largest difference between 1 and the sum of a strand's weights.
    pub off: f32,
}

impl Polygon {
    /// Bounds the weights of a wisp's strands; `None` if no strand has finite weights.
    pub fn of_wisp(set: &StrandSet, wisp: &Wisp) -> Option<Self> {
        let all = set.weights[strands_of(wisp)].iter();
        Self::around(all.copied().filter(|weights| weights.iter().sum::<f32>().is_finite()))
    }

    fn around(weights: impl Iterator<Item = [f32; 3]>) -> Option<Self> {
        let mut low = [f32::INFINITY; 3];
        let mut high = [f32::NEG_INFINITY; 3];
        let mut off = 0.0_f32;
        for [a, b, c] in weights {
            off = off.max((a + b + c - 1.0).abs());
            // The first weight follows from the others, so that all corners lie in the plane.
            for (k, weight) in [1.0 - b - c, b, c].into_iter().enumerate() {
                low[k] = low[k].min(weight);
                high[k] = high[k].max(weight);
            }
        }
        if low[0] > high[0] {
            return None;
        }
        let largest = low.iter().chain(&high).fold(1.0_f32, |largest, weight| largest.max(weight.abs()));
        for k in 0..3 {
            low[k] -= ROUNDING * largest;
            high[k] += ROUNDING * largest;
        }
        let [_, b0, c0] = low;
        let [_, b1, c1] = high;
        let mut polygon = vec![[b0, c0], [b1, c0], [b1, c1], [b0, c1]];
        polygon = cut(&polygon, |[b, c]| 1.0 - b - c - low[0]);
        polygon = cut(&polygon, |[b, c]| high[0] - (1.0 - b - c));
        let last = *polygon.last()?;
        polygon.resize(CORNERS, last);
        let corners = std::array::from_fn(|k| {
            let [b, c] = polygon[k];
            [1.0 - b - c, b, c]
        });
        let sum = corners.iter().map(|w| w.iter().map(|w| w.abs()).sum::<f32>()).fold(1.0, f32::max);
        Some(Self { corners, sum, off })
    }
}

/// The part of a convex polygon where `inside` is not negative (Sutherland and Hodgman 1974).
fn cut(polygon: &[[f32; 2]], inside: impl Fn([f32; 2]) -> f32) -> Vec<[f32; 2]> {
    let mut left = Vec::with_capacity(CORNERS);
    for (k, &from) in polygon.iter().enumerate() {
        let to = polygon[(k + 1) % polygon.len()];
        let (at_from, at_to) = (inside(from), inside(to));
        if at_from >= 0.0 {
            left.push(from);
        }
        if (at_from >= 0.0) != (at_to >= 0.0) {
            let t = at_from / (at_from - at_to);
            left.push([from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])]);
        }
    }
    left
}
