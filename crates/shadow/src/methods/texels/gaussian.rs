//! Lines with a Gaussian profile.

use glam::Vec3;

use super::frame::TexelFrame;
use super::lines::{Along, Draw, Lines, Steps};
use crate::exp::exp_of_minus;

/// Standard deviations on each side of a line that have texels of their own; what lies beyond goes to the last of them. Twin of
/// `REACH` in `filtered_step.wgsl`.
const REACH: f32 = 2.5;

/// The largest standard deviation, texels, so that a step has at most 16 fragments.
const MOST: f32 = 2.0;

/// Lines with a Gaussian profile across them (Mertens et al. 2004, section 3.4): a step is one fragment in each texel across the longer
/// axis that the profile reaches, with the integral of the profile over the texel.
///
/// The paper draws a rectangle with a texture of the profile, whose mip levels approximate this integral.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GaussianLines {
    pub lines: Lines,
    /// Standard deviation, texels.
    pub deviation: f32,
}

/// The standard deviation, in texels, of lines for which it is `line_width` times the width of a strand.
pub(crate) fn line_deviation(line_width: f32, strand_width: f32, frame: &TexelFrame) -> f32 {
    let deviation = line_width * strand_width / frame.texel_size;
    if deviation > 0.0 { deviation.min(MOST) } else { 0.0 }
}

impl GaussianLines {
    /// Fragments per step of a segment with these steps.
    pub(crate) fn per_step(&self, steps: &Steps) -> u64 {
        // A segment without length has no steps.
        (2.0 * REACH * self.deviation * steps.length.min(2.0)).ceil() as u64 + 1
    }
}

impl Draw for GaussianLines {
    #[inline]
    fn draw(&self, from: Vec3, to: Vec3, along: &impl Along, put: &mut impl FnMut(u32, u32, f32, f32)) {
        let steps = Steps::new(from, to);
        let beta = self.lines.depth_per_texel * steps.length;
        // The shorter axis cuts the profile at an angle.
        let deviation = self.deviation * steps.length;
        let count = self.per_step(&steps) as i32;
        let last = self.lines.resolution as i32 - 2;
        for major in steps.first..steps.end {
            let (minor, depth) = steps.at(major);
            let (depth, width) = along.at(steps.way(major as f32 + 0.5), depth);
            let beta = beta * width;
            let first = (minor - REACH * deviation).floor();
            let mut before = 0.0;
            for at in 1..=count {
                let part = if at < count { normal((first + at as f32 - minor) / deviation) } else { 1.0 };
                // The approximation may fall by its error.
                let until = (beta * part).max(before);
                let minor = (first as i32 + at - 1).clamp(1, last) as u32;
                let major = major as u32;
                let (column, row) = if steps.by_row { (minor, major) } else { (major, minor) };
                put(column, row, depth, until - before);
                before = until;
            }
        }
    }
}

/// The cumulative normal distribution, with an error below 2e-7 (Abramowitz, Stegun 1964, "Handbook of Mathematical Functions",
/// 7.1.26). Twin of `normal` in `filtered_step.wgsl`.
fn normal(x: f32) -> f32 {
    let z = x.abs() * std::f32::consts::FRAC_1_SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * z);
    let p = 1.061_405_4_f32;
    let p = p * t - 1.453_152;
    let p = p * t + 1.421_413_7;
    let p = p * t - 0.284_496_74;
    let p = p * t + 0.254_829_6;
    let half = 0.5 * (p * t) * exp_of_minus(z * z);
    if x > 0.0 { 1.0 - half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::texels::lines::Straight;

    const LINES: Lines = Lines { resolution: 64, depth_per_texel: 0.1 };

    fn fragments(deviation: f32, from: Vec3, to: Vec3) -> Vec<(u32, u32, f32, f32)> {
        let mut found = Vec::new();
        let lines = GaussianLines { lines: LINES, deviation };
        lines.draw(from, to, &Straight, &mut |c, r, d, b| found.push((c, r, d, b)));
        let steps = Steps::new(from, to);
        assert_eq!(found.len() as u64, lines.per_step(&steps) * steps.count());
        found
    }

    #[test]
    fn the_cumulative_distribution_is_that_of_tables() {
        // Rounded to 1e-6.
        for (x, expected) in
            [(0.0, 0.5), (0.5, 0.691_462), (1.0, 0.841_345), (1.96, 0.975_002), (3.0, 0.998_65)]
        {
            assert!((normal(x) - expected).abs() < 1e-6, "{x}: {}", normal(x));
            assert!((normal(-x) - (1.0 - expected)).abs() < 1e-6, "{x}");
        }
        assert_eq!((normal(f32::INFINITY), normal(f32::NEG_INFINITY)), (1.0, 0.0));
    }

    #[test]
    fn a_texel_has_the_integral_of_the_profile_over_it() {
        // A line through the middle of row 30, one deviation per texel: Φ(½) − Φ(−½), Φ(1½) − Φ(½), and so on; the first and the
        // last row have the tails.
        let found = fragments(1.0, Vec3::new(3.0, 30.5, 0.5), Vec3::new(4.0, 30.5, 0.5));
        let of = |row: u32| 10.0 * found.iter().filter(|f| f.1 == row).map(|f| f.3).sum::<f32>();
        let integrals = [0.066_807, 0.241_730, 0.382_925, 0.241_730, 0.060_598, 0.006_210];
        for (row, expected) in (28..).zip(integrals) {
            assert!((of(row) - expected).abs() < 1e-5, "{row}: {}", of(row));
        }
        // Control: a narrower line has more in the middle.
        let narrow = fragments(0.5, Vec3::new(3.0, 30.5, 0.5), Vec3::new(4.0, 30.5, 0.5));
        let middle: f32 = narrow.iter().filter(|f| f.1 == 30).map(|f| f.3).sum();
        assert!((10.0 * middle - 0.682_689).abs() < 1e-5, "{middle}");
    }

    #[test]
    fn the_variance_is_that_of_the_profile_and_of_a_texel_wherever_the_line_lies() {
        let mut last = 0.0;
        for deviation in [0.5, 1.0, 2.0] {
            // Means over places of the line within a texel and over slopes, perpendicular to the line.
            let (mut sum, mut square, mut weight) = (0.0_f64, 0.0_f64, 0.0_f64);
            for place in 0..16 {
                let y = 30.0 + place as f32 / 16.0;
                for f in fragments(deviation, Vec3::new(3.0, y, 0.5), Vec3::new(20.0, y, 0.5)) {
                    let off = f64::from(f.1 as f32 + 0.5 - y);
                    sum += f64::from(f.3) * off;
                    square += f64::from(f.3) * off * off;
                    weight += f64::from(f.3);
                }
            }
            let variance = square / weight;
            println!("deviation {deviation}: variance {variance:.4}");
            assert!((sum / weight).abs() < 0.01, "centred");
            // A box of one texel adds a twelfth; the ends that are cut off take less than a tenth.
            let expected = f64::from(deviation * deviation) + 1.0 / 12.0;
            assert!((0.9 * expected..1.02 * expected).contains(&variance), "{variance}, not {expected}");
            assert!(variance > 2.0 * last, "control: wider than the one before");
            last = variance;
        }
    }

    #[test]
    fn lines_have_the_optical_depth_of_thin_ones_and_become_them_without_width() {
        // Also along the border, whose texels stay empty.
        for (a, b) in [((30.0, 31.7), (11.3, 5.1)), ((1.0, 1.0), (60.0, 1.0)), ((62.99, 2.0), (62.99, 50.0))]
        {
            let ends = [Vec3::new(a.0, a.1, 0.2), Vec3::new(b.0, b.1, 0.4)];
            let mut thin = Vec::new();
            LINES.draw(ends[0], ends[1], &Straight, &mut |c, r, d, b| thin.push((c, r, d, b)));
            assert_eq!(fragments(0.0, ends[0], ends[1]), thin);
            let whole: f32 = thin.iter().map(|f| f.3).sum();
            for deviation in [0.1, 0.7, MOST] {
                let found = fragments(deviation, ends[0], ends[1]);
                assert!(
                    found.iter().all(|f| (1..=62).contains(&f.0) && (1..=62).contains(&f.1) && f.3 >= 0.0)
                );
                let sum: f32 = found.iter().map(|f| f.3).sum();
                assert!((sum - whole).abs() < 1e-5 * whole.max(1.0) && whole > 0.0, "{sum}, not {whole}");
            }
        }
    }

    #[test]
    fn segments_without_extent_leave_nothing() {
        let p = Vec3::new(8.5, 8.5, 0.1);
        assert!(fragments(1.0, p, p).is_empty() && fragments(1.0, p, p + Vec3::Z).is_empty());
    }
}
