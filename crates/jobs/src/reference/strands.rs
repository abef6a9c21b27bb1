//! The drawn strands as text for a path tracer.

use std::fmt::Write;
use std::ops::Range;

use glam::Vec3;
use lovelock_groom::PigmentVariation;
use lovelock_render::{DrawnHair, FrameInput};
use rayon::prelude::*;

/// The longest segment in the file, in radii: in longer ones a path tracer meets the surface that it has just left.
const MAX_RADII: f32 = 200.0;

/// The least radius in the file, as a fraction of the strand's largest. A curve of no width has no normal.
const LEAST_TAPER: f32 = 0.02;

/// The strands of one picture, root first.
#[derive(Clone, Debug, Default)]
pub(super) struct DrawnStrands {
    /// World space, metres.
    pub(super) points: Vec<Vec3>,
    /// Half of the width at each point, metres.
    pub(super) half_widths: Vec<f32>,
    /// The points of each strand.
    pub(super) strands: Vec<Range<usize>>,
    /// The shade of each strand, 0 to 1.
    pub(super) shades: Vec<f32>,
}

/// The strands that a renderer draws of `input`, and their half widths. `picture.strands` must be a fixed number or the stored ones:
/// others depend on the size of the image.
///
/// The width is [`shadow_width`](lovelock_groom::HairLook::shadow_width) times the taper: a strand that stands for thirty hairs
/// is as wide as thirty hairs. The path tracer then sees the optical depth that the shadows of Lovelock see. The eye of Lovelock
/// sees it as well if `look.width_scale` and `picture.strand_opacity` are 1, as in the scenes.
pub(super) fn drawn_strands(input: &FrameInput<'_>) -> DrawnStrands {
    // Scenes have a fixed number of strands, which does not depend on the height of the image.
    let drawn = DrawnHair::of(input, 1);
    let strands = &drawn.strands;
    DrawnStrands {
        points: (0..strands.points()).map(|i| strands.point(i)).collect(),
        strands: strands.first_point.windows(2).map(|ends| ends[0] as usize..ends[1] as usize).collect(),
        half_widths: drawn.half_widths,
        shades: drawn.shades,
    }
}

impl DrawnStrands {
    /// The strands with their points and half widths transformed.
    pub(super) fn map(&self, to: impl Fn(Vec3) -> Vec3, scale: f32) -> Self {
        Self {
            points: self.points.iter().map(|&p| to(p)).collect(),
            half_widths: self.half_widths.iter().map(|w| w * scale).collect(),
            strands: self.strands.clone(),
            shades: self.shades.clone(),
        }
    }

    /// The strands as text in the unit of the points.
    pub(super) fn texts(&self) -> StrandTexts {
        let texts = self.strands.par_iter().map(|strand| self.text_of(strand)).collect();
        StrandTexts { texts, shades: self.shades.clone() }
    }

    /// Control points of the cubic B-spline of a strand: `x y z radius` per line. Empty for a strand of a single point.
    ///
    /// A B-spline ends before its last control point, so each end is continued by its own mirror image, and the curve begins and
    /// ends at the strand's ends. Segments longer than 200 radii are divided evenly.
    fn text_of(&self, strand: &Range<usize>) -> String {
        let mut text = String::new();
        if strand.len() > 1 {
            for (p, radius) in self.controls(strand) {
                // Writing to a string does not fail.
                let _ = writeln!(text, "{:.5} {:.5} {:.5} {radius:.6}", p.x, p.y, p.z);
            }
        }
        text
    }

    /// The control points of a strand and their radii.
    fn controls(&self, strand: &Range<usize>) -> Vec<(Vec3, f32)> {
        let widths = &self.half_widths[strand.clone()];
        let least = LEAST_TAPER * widths.iter().copied().fold(0.0, f32::max);
        let ends: Vec<_> =
            self.points[strand.clone()].iter().copied().zip(widths.iter().map(|w| w.max(least))).collect();
        let mut controls = Vec::with_capacity(ends.len() + 2);
        for pair in ends.windows(2) {
            let [(a, from), (b, to)] = [pair[0], pair[1]];
            let parts =
                (a.distance(b) / (MAX_RADII * from.min(to)).max(f32::MIN_POSITIVE)).ceil().clamp(1.0, 1e3);
            for part in 0..parts as u32 {
                let along = part as f32 / parts;
                controls.push((a.lerp(b, along), from + (to - from) * along));
            }
        }
        controls.extend(ends.last());
        // Mirrored and not repeated: a curve whose first three points are one has no direction there.
        if let ([first, second, ..], [.., before, last]) = (controls.as_slice(), controls.as_slice()) {
            let (start, end) = ((2.0 * first.0 - second.0, first.1), (2.0 * last.0 - before.0, last.1));
            controls.insert(0, start);
            controls.push(end);
        }
        controls
    }
}

/// The text of each strand, from which files of all or some of them are put together.
#[derive(Clone, Debug, Default)]
pub(super) struct StrandTexts {
    texts: Vec<String>,
    /// The shade of each strand, 0 to 1.
    shades: Vec<f32>,
}

impl StrandTexts {
    /// The number of strands.
    pub(super) fn count(&self) -> usize {
        self.texts.len()
    }

    /// The file of all strands: their text, and an empty line between them.
    pub(super) fn file(&self) -> String {
        joined(self.texts.iter())
    }

    /// The files of the strands with pigment and of those without, of hair with that share of grey strands.
    pub(super) fn parted_files(&self, grey: f32) -> [String; 2] {
        let variation = PigmentVariation { grey, ..PigmentVariation::default() };
        [false, true].map(|is_white| {
            let of_part = |shade: f32| (variation.factor(0.0, shade, 0) < 1.0) == is_white;
            let pairs = self.texts.iter().zip(&self.shades).filter(|(_, shade)| of_part(**shade));
            joined(pairs.map(|(text, _)| text))
        })
    }
}

/// The texts of strands with an empty line between them.
fn joined<'a>(texts: impl Iterator<Item = &'a String>) -> String {
    let texts: Vec<&str> = texts.filter(|text| !text.is_empty()).map(String::as_str).collect();
    texts.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strands(points: &[[f32; 3]], half_widths: &[f32], lengths: &[usize]) -> DrawnStrands {
        let mut first = 0;
        let ranges = lengths.iter().map(|&length| {
            first += length;
            first - length..first
        });
        DrawnStrands {
            points: points.iter().copied().map(Vec3::from).collect(),
            half_widths: half_widths.to_vec(),
            strands: ranges.collect(),
            shades: vec![0.5; lengths.len()],
        }
    }

    #[test]
    fn ends_are_continued_and_strands_are_separated() {
        let two = strands(
            &[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0, 0.0, 0.0], [5.0, 2.0, 1.0], [9.0, 9.0, 9.0]],
            &[0.5, 0.25, 0.5, 0.5, 0.5],
            &[2, 2, 1],
        );
        let expected = "0.00000 -1.00000 0.00000 0.500000\n\
                        0.00000 0.00000 0.00000 0.500000\n\
                        0.00000 1.00000 0.00000 0.250000\n\
                        0.00000 2.00000 0.00000 0.250000\n\
                        \n\
                        5.00000 -2.00000 -1.00000 0.500000\n\
                        5.00000 0.00000 0.00000 0.500000\n\
                        5.00000 2.00000 1.00000 0.500000\n\
                        5.00000 4.00000 2.00000 0.500000\n";
        let texts = two.texts();
        assert_eq!((texts.count(), texts.file()), (3, expected.to_owned()));
        assert_eq!(texts.parted_files(1.0), [String::new(), texts.file()], "all are white");
        assert_eq!(texts.parted_files(0.0), [texts.file(), String::new()], "none is white");
        // The curve begins where the strand does: (p0 + 4 p1 + p2) / 6.
        let controls = two.controls(&(2..4));
        assert!(((controls[0].0 + 4.0 * controls[1].0 + controls[2].0) / 6.0).distance(Vec3::X * 5.0) < 1e-6);
    }

    #[test]
    fn no_segment_is_longer_than_200_radii() {
        let long = strands(&[[0.0; 3], [0.0, -50.0, 0.0], [0.0, -51.0, 0.0]], &[0.1, 0.1, 0.1], &[3]);
        let controls = long.controls(&(0..3));
        // 500 radii are three parts: 3 + 1 segments, 5 points, and one more at either end.
        assert_eq!(controls.len(), 7);
        assert!(controls.windows(2).all(|pair| pair[0].0.distance(pair[1].0) <= MAX_RADII * 0.1 + 1e-3));
    }

    #[test]
    fn a_tip_of_no_width_keeps_some() {
        let strand = strands(&[[0.0; 3], [0.0, 1.0, 0.0]], &[0.5, 0.0], &[2]);
        assert!(strand.controls(&(0..2)).iter().all(|(_, radius)| *radius >= 0.5 * LEAST_TAPER));
    }
}
