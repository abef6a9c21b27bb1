//! Rasterisation of segments into fragments.

use glam::Vec3;

use crate::perspective::Ray;

/// Rasterises segments.
pub(crate) trait Draw: Sync {
    /// Calls `put` for each fragment of the segment between two points, which are columns, rows and depths from 0 to 1. A fragment
    /// is a column, a row, a depth and an optical depth. `along` says what the segment is between its ends.
    fn draw(&self, from: Vec3, to: Vec3, along: &impl Along, put: &mut impl FnMut(u32, u32, f32, f32));
}

/// What a segment is between its ends.
pub(crate) trait Along {
    /// Its depth and the factor on its width at the fraction `t` of its way across the light, where a line between its ends has the depth
    /// `depth`.
    fn at(&self, t: f32, depth: f32) -> (f32, f32);

    /// The largest factor on its width.
    fn widest(&self) -> f32;
}

/// A straight segment of one width.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Straight;

impl Along for Straight {
    #[inline]
    fn at(&self, _t: f32, depth: f32) -> (f32, f32) {
        (depth, 1.0)
    }

    fn widest(&self) -> f32 {
        1.0
    }
}

/// A segment that was projected from a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curved {
    pub ray: Ray,
    /// Depth per metre, and the depth of distance 0.
    pub per_metre: f32,
    pub first: f32,
}

impl Along for Curved {
    #[inline]
    fn at(&self, t: f32, _depth: f32) -> (f32, f32) {
        let [distance, width] = self.ray.at(t);
        ((distance * self.per_metre + self.first).clamp(0.0, 1.0), width)
    }

    fn widest(&self) -> f32 {
        self.ray.widest()
    }
}

/// A segment as steps along its longer axis, from its lower to its higher end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steps {
    /// Whether rows are the longer axis.
    pub by_row: bool,
    /// The first texel on the longer axis whose centre lies between the ends, the lower end included.
    pub first: i32,
    /// One after the last texel.
    pub end: i32,
    /// Length of the segment across the light per step, texels: 1 to √2.
    pub length: f32,
    /// The lower end: coordinates on the longer and the shorter axis, and depth.
    start: [f32; 3],
    /// Whether the lower end is the first one.
    forward: bool,
    /// The coordinate of the higher end on the longer axis.
    high: f32,
    /// The difference between the ends on the shorter axis and in depth.
    rise: [f32; 2],
    per_texel: f32,
}

impl Steps {
    /// The steps of a segment with non-negative coordinates; none if it passes no centre of a texel.
    ///
    /// The interval is half open, so that a vertex that two segments share is counted once.
    #[inline]
    pub(crate) fn new(from: Vec3, to: Vec3) -> Self {
        let d = to - from;
        let by_row = d.y.abs() > d.x.abs();
        let turned = |p: Vec3| if by_row { [p.y, p.x, p.z] } else { [p.x, p.y, p.z] };
        let (a, b) = (turned(from), turned(to));
        let (low, high) = if a[0] <= b[0] { (a, b) } else { (b, a) };
        let long = high[0] - low[0];
        // A segment without length contains no centre, so these values are not used.
        let per_texel = 1.0 / long;
        Self {
            by_row,
            first: centres_below(low[0]),
            end: centres_below(high[0]),
            length: (d.x * d.x + d.y * d.y).sqrt() * per_texel,
            start: low,
            forward: a[0] <= b[0],
            high: high[0],
            rise: [high[1] - low[1], high[2] - low[2]],
            per_texel,
        }
    }

    /// Number of steps.
    pub(crate) fn count(&self) -> u64 {
        (self.end - self.first) as u64
    }

    /// The texels of the longer axis that the segment touches.
    pub(crate) fn touched(&self) -> std::ops::Range<i32> {
        self.start[0].floor() as i32..self.high.ceil() as i32
    }

    /// The fraction of texel `at` of the longer axis that lies between the ends, 0 to 1, and the coordinate on the shorter axis
    /// and the depth in the middle of that part. The latter are valid only if the fraction is above 0.
    #[inline]
    pub(crate) fn covered(&self, at: i32) -> (f32, f32, f32) {
        let (low, high) = (self.start[0].max(at as f32), self.high.min(at as f32 + 1.0));
        let t = (0.5 * (low + high) - self.start[0]) * self.per_texel;
        (high - low, self.start[1] + t * self.rise[0], (self.start[2] + t * self.rise[1]).clamp(0.0, 1.0))
    }

    /// The coordinate in the middle of the part of texel `at` of the longer axis that lies between the ends.
    #[inline]
    pub(crate) fn middle(&self, at: i32) -> f32 {
        0.5 * (self.start[0].max(at as f32) + self.high.min(at as f32 + 1.0))
    }

    /// The fraction of the way from the first end to the second at a coordinate on the longer axis.
    #[inline]
    pub(crate) fn way(&self, at: f32) -> f32 {
        let t = (at - self.start[0]) * self.per_texel;
        if self.forward { t } else { 1.0 - t }
    }

    /// The coordinate on the shorter axis, and the depth, at the centre of texel `at` of the longer axis.
    #[inline]
    pub(crate) fn at(&self, at: i32) -> (f32, f32) {
        let t = (at as f32 + 0.5 - self.start[0]) * self.per_texel;
        // Rounding must not leave the range of depths.
        (self.start[1] + t * self.rise[0], (self.start[2] + t * self.rise[1]).clamp(0.0, 1.0))
    }
}

/// The number of texel centres below `c`, which is not negative: `⌈c − ½⌉`.
#[inline]
fn centres_below(c: f32) -> i32 {
    let whole = c as i32;
    whole + i32::from(c - whole as f32 > 0.5)
}

/// Lines one texel wide: a step along the longer axis is one fragment with the whole optical depth of the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lines {
    /// Texels along each edge; those at the border stay empty.
    pub resolution: u32,
    /// Optical depth of a piece of strand whose length across the light is one texel.
    pub depth_per_texel: f32,
}

impl Draw for Lines {
    #[inline]
    fn draw(&self, from: Vec3, to: Vec3, along: &impl Along, put: &mut impl FnMut(u32, u32, f32, f32)) {
        let steps = Steps::new(from, to);
        let beta = self.depth_per_texel * steps.length;
        let last = self.resolution as i32 - 2;
        for major in steps.first..steps.end {
            let (minor, depth) = steps.at(major);
            let (depth, width) = along.at(steps.way(major as f32 + 0.5), depth);
            let minor = (minor as i32).clamp(1, last) as u32;
            let major = major as u32;
            let (column, row) = if steps.by_row { (minor, major) } else { (major, minor) };
            put(column, row, depth, beta * width);
        }
    }
}

/// Pre-filtered lines: a step is one fragment in each of the two nearest texels across the longer axis, which share its optical
/// depth by the distance of their centres (Wu 1991, "An Efficient Antialiasing Technique"; Mertens et al. 2004, section 3.4).
#[derive(Clone, Copy, Debug)]
pub(crate) struct FilteredLines(pub Lines);

impl FilteredLines {
    /// Fragments per step.
    pub(crate) const PER_STEP: u64 = 2;
}

impl Draw for FilteredLines {
    #[inline]
    fn draw(&self, from: Vec3, to: Vec3, along: &impl Along, put: &mut impl FnMut(u32, u32, f32, f32)) {
        let steps = Steps::new(from, to);
        let beta = self.0.depth_per_texel * steps.length;
        let last = self.0.resolution as i32 - 2;
        for major in steps.first..steps.end {
            let (minor, depth) = steps.at(major);
            let (depth, width) = along.at(steps.way(major as f32 + 0.5), depth);
            let beta = beta * width;
            let at = minor - 0.5;
            let low = at.floor();
            let second = beta * (at - low);
            for (minor, beta) in [(low as i32, beta - second), (low as i32 + 1, second)] {
                let minor = minor.clamp(1, last) as u32;
                let major = major as u32;
                let (column, row) = if steps.by_row { (minor, major) } else { (major, minor) };
                put(column, row, depth, beta);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINES: Lines = Lines { resolution: 64, depth_per_texel: 0.1 };

    fn fragments(of: &[Vec3]) -> Vec<(u32, u32, f32, f32)> {
        let mut found = Vec::new();
        for ends in of.windows(2) {
            LINES.draw(ends[0], ends[1], &Straight, &mut |c, r, d, b| found.push((c, r, d, b)));
        }
        found
    }

    #[test]
    fn a_row_of_texels_is_filled_in_both_directions() {
        let (a, b) = (Vec3::new(3.0, 7.3, 0.2), Vec3::new(9.0, 7.3, 0.8));
        for ends in [[a, b], [b, a]] {
            let mut found = fragments(&ends);
            found.sort_by_key(|f| f.0);
            assert_eq!(
                found.iter().map(|f| (f.0, f.1)).collect::<Vec<_>>(),
                [3, 4, 5, 6, 7, 8].map(|c| (c, 7))
            );
            for f in found {
                assert!((f.2 - (0.2 + 0.1 * (f.0 as f32 + 0.5 - 3.0))).abs() < 1e-6, "depth at the centre");
                assert_eq!(f.3, 0.1);
            }
        }
    }

    #[test]
    fn shared_vertices_are_counted_once() {
        // Vertices on centres, on borders, and anywhere.
        for offset in [0.0, 0.5, 0.37] {
            let whole = fragments(&[Vec3::new(2.0 + offset, 5.2, 0.1), Vec3::new(32.0 + offset, 11.2, 0.7)]);
            let parts: Vec<_> = (0..=30)
                .map(|i| Vec3::new(2.0 + offset + i as f32, 5.2 + 0.2 * i as f32, 0.1 + 0.02 * i as f32))
                .collect();
            let found = fragments(&parts);
            assert_eq!((whole.len(), found.len()), (30, 30));
            let back: Vec<_> = parts.into_iter().rev().collect();
            assert_eq!(fragments(&back).len(), 30);
        }
    }

    #[test]
    fn optical_depth_is_that_of_the_length() {
        for turn in 0..64 {
            let angle = turn as f32 * 0.0981;
            let d = 25.0 * Vec3::new(angle.cos(), angle.sin(), 0.0);
            let found = fragments(&[Vec3::new(32.1, 31.7, 0.5) - d, Vec3::new(32.1, 31.7, 0.5) + d]);
            let sum: f32 = found.iter().map(|f| f.3).sum();
            // One step more or less at the ends, out of about 40.
            assert!((sum - 5.0).abs() < 0.15, "{angle}: {sum}");
        }
    }

    /// A segment whose width grows from 1 to 3 and whose depth is a square.
    struct Widening;

    impl Along for Widening {
        fn at(&self, t: f32, _depth: f32) -> (f32, f32) {
            (t * t, 1.0 + 2.0 * t)
        }

        fn widest(&self) -> f32 {
            3.0
        }
    }

    #[test]
    fn depth_and_width_are_those_along_the_segment_in_both_directions() {
        let (a, b) = (Vec3::new(3.0, 7.3, 0.2), Vec3::new(9.0, 7.3, 0.8));
        for (from, to) in [(a, b), (b, a)] {
            let mut found = Vec::new();
            LINES.draw(from, to, &Widening, &mut |c, _, d, b| found.push((c, d, b)));
            assert_eq!(found.len(), 6);
            for (column, depth, beta) in found {
                let t = (column as f32 + 0.5 - from.x) / (to.x - from.x);
                assert!((depth - t * t).abs() < 1e-6 && (beta - 0.1 * (1.0 + 2.0 * t)).abs() < 1e-6, "{t}");
            }
        }
    }

    #[test]
    fn filtered_lines_share_a_step_by_the_distance_of_centres() {
        let mut found = Vec::new();
        let ends = [Vec3::new(3.0, 7.75, 0.5), Vec3::new(5.0, 7.75, 0.5)];
        FilteredLines(LINES).draw(ends[0], ends[1], &Straight, &mut |c, r, d, b| found.push((c, r, d, b)));
        let expected = [(3, 7, 0.075), (3, 8, 0.025), (4, 7, 0.075), (4, 8, 0.025)];
        assert_eq!(found.len(), expected.len());
        for (found, (column, row, beta)) in found.iter().zip(expected) {
            assert_eq!((found.0, found.1, found.2), (column, row, 0.5));
            assert!((found.3 - beta).abs() < 1e-7, "{found:?}");
        }
    }

    #[test]
    fn filtered_lines_have_the_optical_depth_of_thin_ones() {
        // Also along the border, whose texels stay empty.
        for (a, b) in [((30.0, 31.7), (11.3, 5.1)), ((1.0, 1.0), (60.0, 1.0)), ((62.99, 2.0), (62.99, 50.0))]
        {
            let ends = [Vec3::new(a.0, a.1, 0.2), Vec3::new(b.0, b.1, 0.4)];
            let thin: f32 = fragments(&ends).iter().map(|f| f.3).sum();
            let mut filtered = 0.0;
            FilteredLines(LINES).draw(ends[0], ends[1], &Straight, &mut |c, r, _, beta| {
                assert!((1..=62).contains(&c) && (1..=62).contains(&r) && beta >= 0.0);
                filtered += beta;
            });
            assert!((thin - filtered).abs() < 1e-5 && thin > 0.0, "{thin} and {filtered}");
        }
    }

    #[test]
    fn segments_without_extent_leave_nothing() {
        let p = Vec3::new(8.5, 8.5, 0.1);
        assert!(fragments(&[p, p]).is_empty());
        assert!(fragments(&[p, p + Vec3::Z]).is_empty(), "along the light");
    }

    #[test]
    fn the_border_stays_empty() {
        let (low, high) = (1.0, 63.0 * (1.0 - f32::EPSILON));
        let corners = [(low, low), (high, low), (high, high), (low, high), (low, low), (high, high)];
        let corners = corners.map(|(x, y)| Vec3::new(x, y, 0.5));
        for f in fragments(&corners) {
            assert!((1..=62).contains(&f.0) && (1..=62).contains(&f.1), "{f:?}");
        }
    }
}
