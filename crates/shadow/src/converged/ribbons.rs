//! Strands as ribbons that cover fractions of subtexels.

use std::ops::Range;
use std::sync::Arc;

use glam::Vec3;

use crate::ShadowInput;
use crate::cpu::safe_extinction;
use crate::methods::texels::TexelFrame;
use crate::methods::texels::lines::{Along, Draw, Steps};

/// The largest optical depth of a ribbon; e^−10⁴ is 0 in any float.
const MAX_DEPTH: f32 = 1e4;

/// Rasterises ribbons into rows of subtexels.
///
/// Along its longer axis a segment advances by subtexels, and covers fractions of the first and the last. On the shorter axis the
/// ribbon covers an interval of its width divided by the cosine of its slope. Each subtexel receives its covered fraction.
#[derive(Clone, Debug)]
pub(super) struct Ribbons {
    /// Subtexels along the edge of a texel.
    pub samples: u32,
    /// Texels along the edge of the map.
    resolution: u32,
    /// The rows of subtexels to rasterise.
    pub rows: Range<u32>,
    /// Width of a ribbon, subtexels.
    width: f32,
    /// Optical depth of a ribbon.
    depth: f32,
    /// Texels that a footprint touches, row after row.
    wanted: Arc<[bool]>,
}

impl Ribbons {
    /// Ribbons over all rows, for the footprints around `places` (in texel coordinates).
    pub(super) fn new(input: &ShadowInput, frame: &TexelFrame, samples: u32, places: &[Vec3]) -> Self {
        let resolution = frame.resolution;
        let width = input.strand_width / frame.texel_size * samples as f32;
        let depth = safe_extinction(input.extinction_scale).min(MAX_DEPTH);
        // Nothing is wider than the map.
        let width = if width > 0.0 { width.min((resolution * samples) as f32) } else { 0.0 };
        let mut wanted = vec![false; (resolution * resolution) as usize];
        let end = resolution as f32 + 1.0;
        for p in places {
            if !(p.x > -1.0 && p.x < end && p.y > -1.0 && p.y < end && p.z > 0.0) {
                continue;
            }
            let (column, row) = ((p.x - 0.5).floor() as i32, (p.y - 0.5).floor() as i32);
            for (column, row) in [(column, row), (column + 1, row), (column, row + 1), (column + 1, row + 1)]
            {
                if (0..resolution as i32).contains(&column) && (0..resolution as i32).contains(&row) {
                    wanted[row as usize * resolution as usize + column as usize] = true;
                }
            }
        }
        Self { samples, resolution, rows: 0..resolution * samples, width, depth, wanted: wanted.into() }
    }

    /// The same ribbons within `rows` only.
    pub(super) fn within(&self, rows: &Range<u32>) -> Self {
        Self { rows: rows.clone(), ..self.clone() }
    }

    /// Subtexels in a row.
    pub(super) fn columns(&self) -> u32 {
        self.resolution * self.samples
    }

    /// Calls `with` for the rows of texels that a segment may touch, each with an upper bound of its fragments there.
    pub(super) fn bound(&self, (from, to): (Vec3, Vec3), widest: f32, mut with: impl FnMut(u32, u64)) {
        let steps = self.steps(from, to);
        let across = f64::from(self.width * widest * steps.length) + 2.0;
        let reach = if steps.by_row { 0.0 } else { (across / f64::from(self.samples)) as f32 };
        let last = self.resolution - 1;
        let low = ((from.y.min(to.y) - reach).max(0.0) as u32).min(last);
        let high = ((from.y.max(to.y) + reach).max(0.0) as u32).min(last);
        let rows = f64::from(high - low + 1);
        // Fragments are spread evenly over the rows, but there are never more than fit.
        let count = f64::from(steps.touched().len() as u32);
        let all = count * across;
        let most = f64::from(self.samples) * if steps.by_row { across } else { count };
        let each = (2.0 * all / rows).min(most).ceil() as u64;
        (low..=high).for_each(|row| with(row, each));
    }

    fn steps(&self, from: Vec3, to: Vec3) -> Steps {
        let scale = Vec3::new(self.samples as f32, self.samples as f32, 1.0);
        Steps::new(from * scale, to * scale)
    }

    /// Whether a segment may touch a texel of a footprint: a conservative test of the texels around it.
    fn may_touch_wanted(&self, from: Vec3, to: Vec3, widest: f32) -> bool {
        /// A segment over more texels than this is always rasterised.
        const MAX: u32 = 1024;
        // Half the width over the cosine of at most 45 degrees.
        let reach = Vec3::splat(0.71 * self.width * widest / self.samples as f32);
        let last = (self.resolution - 1) as f32;
        let low = (from.min(to) - reach).clamp(Vec3::ZERO, Vec3::splat(last));
        let high = (from.max(to) + reach).clamp(Vec3::ZERO, Vec3::splat(last));
        let columns = low.x as usize..high.x as usize + 1;
        let rows = low.y as u32..high.y as u32 + 1;
        if rows.len() as u32 * columns.len() as u32 > MAX {
            return true;
        }
        rows.into_iter().any(|row| {
            let start = (row * self.resolution) as usize;
            self.wanted[start + columns.start..start + columns.end].contains(&true)
        })
    }

    #[inline]
    fn wants(&self, column: u32, row: u32) -> bool {
        self.wanted[(row / self.samples * self.resolution + column / self.samples) as usize]
    }
}

impl Draw for Ribbons {
    fn draw(&self, from: Vec3, to: Vec3, along: &impl Along, put: &mut impl FnMut(u32, u32, f32, f32)) {
        if !self.may_touch_wanted(from, to, along.widest()) {
            return;
        }
        let steps = self.steps(from, to);
        let half_of = 0.5 * self.width * steps.length;
        let columns = self.columns();
        let (long, wide) =
            if steps.by_row { (&self.rows, 0..columns) } else { (&(0..columns), self.rows.clone()) };
        let touched = steps.touched();
        for major in touched.start.max(long.start as i32)..touched.end.min(long.end as i32) {
            let (part, middle, depth) = steps.covered(major);
            let (depth, width) = along.at(steps.way(steps.middle(major)), depth);
            let half = half_of * width;
            // False for a segment without length across the light.
            if !(part > 0.0 && half >= 0.0) {
                continue;
            }
            let (low, high) = (middle - half, middle + half);
            let start = low.max(wide.start as f32) as u32;
            let end = (high.min(wide.end as f32).ceil().max(0.0)) as u32;
            for minor in start.max(wide.start)..end {
                let covered = high.min(minor as f32 + 1.0) - low.max(minor as f32);
                let (column, row) = if steps.by_row { (minor, major as u32) } else { (major as u32, minor) };
                if covered > 0.0 && self.wants(column, row) {
                    put(column, row - self.rows.start, depth, self.depth * part * covered.min(1.0));
                }
            }
        }
    }
}
