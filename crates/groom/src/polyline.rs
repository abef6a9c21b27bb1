//! Lays the links of a chain along a polyline.

use glam::Vec3;

/// The search range for the next point past the end of the polyline, and the search step, both in segments.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// How far past the end.
    pub beyond: f32,
    /// The step.
    pub step: f32,
}

/// The first position on the polyline after `at`, in segments, whose distance from `from` is `link`. Past the end, the
/// last segment is extended.
pub fn next_at(target: &[Vec3], at: f32, from: Vec3, link: f32, reach: Reach) -> f32 {
    let last = (target.len() - 1) as f32 + reach.beyond;
    let mut low = at;
    let mut high = at;
    while high < last && sample(target, high).distance(from) < link {
        low = high;
        high += reach.step;
    }
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        if sample(target, middle).distance(from) < link {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// The point of a polyline (two points or more) at position `at`, in segments; the last segment is extended past its
/// end.
pub fn sample(target: &[Vec3], at: f32) -> Vec3 {
    let i = (at as usize).min(target.len() - 2);
    target[i] + (target[i + 1] - target[i]) * (at - i as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_ends_on_the_polyline_and_past_its_end() {
        let way = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0)];
        let reach = Reach { beyond: 8.0, step: 0.25 };
        for (link, wanted) in [(0.5, 0.5), (2.0_f32.sqrt(), 2.0), (5.0_f32.sqrt(), 3.0)] {
            let at = next_at(&way, 0.0, Vec3::ZERO, link, reach);
            // A quarter of a segment halved sixteen times, and rounding.
            assert!((at - wanted).abs() < 2e-5, "{link}: {at}");
        }
        assert_eq!(sample(&way, 3.0), Vec3::new(1.0, 2.0, 0.0));
    }
}
