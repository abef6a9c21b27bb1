//! All fragments of a tile, per pixel.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use std::cmp::Ordering;

use lovelock_base::memory::list_bytes;
use lovelock_base::simd_versions;

use super::fragments::{Span, SpanSink, each_span};
use crate::cpu::math::{clamp, floor};
use crate::cpu::strand_points::ShadedPoint;
use crate::cpu::surface::raster::SurfaceSamples;
use crate::cpu::tile::{BLOCK_LANES, BLOCK_WIDTH, STRIDE, TILE, pixel_of};

/// One segment in one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Fragment {
    /// Depth, 1 at the near plane.
    pub depth: f32,
    /// Opacity times coverage of the pixel, before the body hides it.
    pub alpha: f32,
    /// Light, linear.
    pub color: [f32; 3],
    /// One bit per sample of the pixel: set if the fragment is in front of the body.
    pub seen: u32,
    /// The samples that it covers if strands are opaque; see [`covered_samples`].
    pub covered: u32,
}

/// The samples of a pixel that an opacity covers: their number is four times the opacity, rounded up or down by a hash of the
/// pixel and the strand; the first one depends on the strand. Strands of a pixel cover different samples, so that many thin ones
/// add up. Twin of `covered_samples` in `eye/opaque/samples.wgsl`.
#[inline(always)]
pub(crate) fn covered_samples(alpha: f32, [x, y]: [f32; 2], hash: f32) -> u32 {
    let inner = x * 0.067_110_56 + y * 0.005_837_15;
    let inner = (inner - floor(inner)) * 52.982_918_9 + 13.7 * hash;
    let noise = inner - floor(inner);
    let count = clamp(floor(alpha * 4.0 + noise), 0.0, 4.0) as u32;
    let first = (hash * 4.0) as u32 & 3;
    let samples = ((1 << count) - 1) << first;
    (samples | samples >> 4) & 15
}

impl Fragment {
    /// Opacity in the samples that the body does not hide.
    pub fn opacity(&self) -> f32 {
        self.alpha * 0.25 * self.seen.count_ones() as f32
    }
}

/// The fragments of a tile.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fragments {
    found: Vec<(u32, Fragment)>,
    starts: Vec<u32>,
    by_pixel: Vec<Fragment>,
    /// Of each fragment its depth, nearest first, above its index in `found`.
    keys: Vec<u64>,
}

/// The input of a tile.
pub(crate) struct ListTile<'a> {
    /// The corner of the tile, pixels.
    pub origin: [f32; 2],
    pub points: &'a [ShadedPoint],
    /// First point of each segment.
    pub segments: &'a [u32],
    /// For each of the indices in `segments`, the segment's first point.
    pub first_points: &'a [u32],
    pub samples: &'a SurfaceSamples,
    /// Opacity of a strand where it covers a pixel completely.
    pub opacity: f32,
}

simd_versions! {
    /// [`list_segments`] for the vectors of `width`.
    pub(crate) fn list_segments_simd(input: &ListTile, out: &mut Fragments) -> () {
        list_segments(input, out)
    }
}

/// Lists the fragments of segments in the pixels of a tile.
#[inline(always)]
fn list_segments(input: &ListTile, out: &mut Fragments) {
    let mut sink = List { origin: input.origin, samples: input.samples, found: &mut out.found };
    for &segment in input.segments {
        let first = input.first_points[segment as usize] as usize;
        let (a, b) = (&input.points[first], &input.points[first + 1]);
        each_span(a, b, input.origin, input.opacity, &mut sink);
    }
}

struct List<'a> {
    origin: [f32; 2],
    samples: &'a SurfaceSamples,
    found: &'a mut Vec<(u32, Fragment)>,
}

impl SpanSink for List<'_> {
    #[inline(always)]
    fn take(&mut self, a: &ShadedPoint, b: &ShadedPoint, span: &Span) {
        let (left, top) = pixel_of(span.block, 0);
        let mut seen = [0_u32; BLOCK_LANES];
        for lane in 0..BLOCK_LANES {
            let body = self.samples.depths((top + lane / BLOCK_WIDTH) * STRIDE + left + lane % BLOCK_WIDTH);
            for (sample, body) in body.into_iter().enumerate() {
                seen[lane] |= u32::from(span.depth[lane] >= body) << sample;
            }
        }
        // All lanes, because a loop that skips some is not compiled to vectors.
        let mut colors = [[0.0; BLOCK_LANES]; 3];
        for (c, colors) in colors.iter_mut().enumerate() {
            for lane in 0..BLOCK_LANES {
                let (t, gain) = (span.along[lane], span.gain[lane]);
                colors[lane] = (a.color[c] + (b.color[c] - a.color[c]) * t) * gain;
            }
        }
        let mut covered = [0_u32; BLOCK_LANES];
        for lane in 0..BLOCK_LANES {
            let (x, y) = (left + lane % BLOCK_WIDTH, top + lane / BLOCK_WIDTH);
            let pixel = [self.origin[0] + x as f32, self.origin[1] + y as f32];
            covered[lane] = covered_samples(span.alpha[lane], pixel, a.hash);
        }
        for lane in 0..BLOCK_LANES {
            let (alpha, seen) = (span.alpha[lane], seen[lane]);
            if alpha > 0.0 && seen != 0 {
                let at = (top + lane / BLOCK_WIDTH) * STRIDE + left + lane % BLOCK_WIDTH;
                let color = colors.map(|lanes| lanes[lane]);
                let (depth, covered) = (span.depth[lane], covered[lane]);
                self.found.push((at as u32, Fragment { depth, alpha, color, seen, covered }));
            }
        }
    }
}

impl Fragments {
    /// Their memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.found)
            + list_bytes(&self.starts)
            + list_bytes(&self.by_pixel)
            + list_bytes(&self.keys)
    }

    /// Begins an empty list.
    pub fn clear(&mut self) {
        self.found.clear();
    }

    /// Adds a fragment in the pixel at `at` of the planes.
    pub fn push(&mut self, at: usize, fragment: Fragment) {
        self.found.push((at as u32, fragment));
    }

    /// Groups the fragments by pixel and calls `visit` for each pixel that has any, with its index in the planes and its fragments in
    /// the order of their segments.
    pub fn each_pixel(&mut self, mut visit: impl FnMut(usize, &mut [Fragment])) {
        if self.found.is_empty() {
            return;
        }
        self.by_pixel.resize(self.found.len(), Fragment::default());
        let by_pixel = &mut self.by_pixel;
        place_by_pixel(&self.found, &mut self.starts, |slot, _, fragment| by_pixel[slot] = *fragment);
        each_range(&self.starts, |at, range| visit(at, &mut by_pixel[range]));
    }

    /// As [`Fragments::each_pixel`], with the fragments of each pixel in the order of [`nearest_first`].
    pub fn each_pixel_nearest_first(&mut self, mut visit: impl FnMut(usize, &[Fragment])) {
        if self.found.is_empty() {
            return;
        }
        self.keys.resize(self.found.len(), 0);
        // Eight bytes per fragment are placed and sorted, and a fragment is copied once.
        let Self { found, starts, by_pixel, keys } = self;
        place_by_pixel(found, starts, |slot, index, fragment| {
            keys[slot] = u64::from(nearness_key(fragment.depth)) << 32 | index as u64;
        });
        each_range(starts, |at, range| {
            let keys = &mut keys[range];
            keys.sort_unstable();
            by_pixel.clear();
            by_pixel.extend(keys.iter().map(|&key| found[key as u32 as usize].1));
            // Equal depths are as good as never neighbours.
            if keys.windows(2).any(|pair| pair[0] >> 32 == pair[1] >> 32) {
                by_pixel.sort_by(nearest_first);
            }
            visit(at, by_pixel);
        });
    }
}

/// Places in a tile.
const PLACES: usize = TILE * STRIDE;

/// Counts the fragments of each pixel, and calls `place` for each fragment with its slot among those of all pixels and its index in
/// `found`. Afterwards, `starts` holds the end of each pixel's slots.
fn place_by_pixel(
    found: &[(u32, Fragment)],
    starts: &mut Vec<u32>,
    mut place: impl FnMut(usize, usize, &Fragment),
) {
    starts.clear();
    starts.resize(PLACES + 1, 0);
    for (at, _) in found {
        starts[*at as usize + 1] += 1;
    }
    for at in 0..PLACES {
        starts[at + 1] += starts[at];
    }
    // Each start advances to the end of its pixel, the original start of the next one.
    for (index, (at, fragment)) in found.iter().enumerate() {
        let slot = &mut starts[*at as usize];
        place(*slot as usize, index, fragment);
        *slot += 1;
    }
}

/// Calls `visit` with each pixel that has fragments, and their slots.
fn each_range(ends: &[u32], mut visit: impl FnMut(usize, std::ops::Range<usize>)) {
    let mut start = 0;
    for (at, &end) in ends.iter().enumerate().take(PLACES) {
        let end = end as usize;
        if end > start {
            visit(at, start..end);
        }
        start = end;
    }
}

/// The order of fragments from near to far. Ties are broken by the other values, so that a result does not depend on the order of the
/// list.
pub(crate) fn nearest_first(a: &Fragment, b: &Fragment) -> Ordering {
    let bits =
        |fragment: &Fragment| (fragment.alpha.to_bits(), fragment.color.map(f32::to_bits), fragment.seen);
    b.depth.total_cmp(&a.depth).then_with(|| bits(a).cmp(&bits(b)))
}

/// A number that rises where [`f32::total_cmp`] of the depth falls.
fn nearness_key(depth: f32) -> u32 {
    let bits = depth.to_bits();
    // Negative numbers are all flipped, others have their sign set; then the order is reversed.
    !(bits ^ (((bits as i32 >> 31) as u32) | 0x8000_0000))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Transparency;
    use crate::cpu::transparency::resolve;

    #[test]
    fn an_opacity_takes_its_share_of_the_samples_and_strands_take_different_ones() {
        for alpha in [0.05, 0.3, 0.5, 0.97] {
            let (mut sum, mut taken) = (0, [0_u32; 4]);
            for i in 0..64_000_u32 {
                let pixel = [(i % 80) as f32, (i / 80) as f32];
                let samples = covered_samples(alpha, pixel, (i % 7) as f32 / 7.0);
                sum += samples.count_ones();
                for (sample, taken) in taken.iter_mut().enumerate() {
                    *taken += samples >> sample & 1;
                }
            }
            let share = sum as f32 / (4.0 * 64_000.0);
            // The hash is uniform to about one per cent over this many pixels.
            assert!((share - alpha).abs() < 0.01, "{alpha}: {share}");
            assert!(taken.iter().all(|&count| count > 0), "{alpha}: {taken:?}");
        }
        assert_eq!(covered_samples(1.0, [3.0, 5.0], 0.4), 15);
        assert_eq!(covered_samples(0.0, [3.0, 5.0], 0.4), 0);
    }

    /// Strands along x at the heights `ys`, each 40 pixels long from x = -4 and of the given half width.
    fn strands(ys: &[f32], half_width: f32) -> (Vec<ShadedPoint>, Vec<u32>) {
        let point = |x: f32, y: f32, depth: f32| ShadedPoint {
            x,
            y,
            depth,
            half_width,
            run_x: 1.0,
            run_y: 0.0,
            color: [0.5; 3],
            hash: 0.0,
        };
        let points = ys
            .iter()
            .enumerate()
            .flat_map(|(i, &y)| {
                let depth = 0.5 - 0.001 * i as f32;
                [point(-4.0, y, depth), point(36.0, y, depth)]
            })
            .collect();
        (points, (0..ys.len() as u32).map(|i| 2 * i).collect())
    }

    /// What the exact blend of the tile at `origin` lets through at each pixel of column `x`, from the top.
    fn through(ys: &[f32], half_width: f32, opacity: f32, origin: [f32; 2], x: usize) -> [f32; TILE] {
        let (points, first_points) = strands(ys, half_width);
        let segments: Vec<u32> = (0..ys.len() as u32).collect();
        let samples = Box::<SurfaceSamples>::default();
        let input = ListTile {
            origin,
            points: &points,
            segments: &segments,
            first_points: &first_points,
            samples: &samples,
            opacity,
        };
        let mut fragments = Fragments::default();
        list_segments(&input, &mut fragments);
        let mut column = [1.0; TILE];
        fragments.each_pixel(|at, fragments| {
            if at % STRIDE == x {
                column[at / STRIDE] = resolve(Transparency::Exact, fragments).through;
            }
        });
        column
    }

    #[test]
    fn keys_order_fragments_as_comparisons_do() {
        let depths = [0.5, 0.25, 0.5, 1.0, 0.0, -0.0, -1.0, f32::NAN, -f32::NAN, f32::INFINITY, 0.5];
        let mut fragments = Fragments::default();
        for (i, depth) in depths.into_iter().enumerate() {
            let alpha = 1.0 / (1.0 + (i * 7 % 5) as f32);
            for at in [3, 2 * STRIDE] {
                fragments.push(at, Fragment { depth, alpha, seen: 15, ..Fragment::default() });
            }
        }
        let bits = |of: &[Fragment]| -> Vec<_> {
            of.iter().map(|fragment| (fragment.depth.to_bits(), fragment.alpha.to_bits())).collect()
        };
        let (mut wanted, mut listed) = (Vec::new(), Vec::new());
        fragments.each_pixel(|at, of| {
            listed.push((at, bits(of)));
            of.sort_by(nearest_first);
            wanted.push((at, bits(of)));
        });
        let mut found = Vec::new();
        fragments.each_pixel_nearest_first(|at, of| found.push((at, bits(of))));
        assert_eq!(found.len(), 2);
        assert!(found == wanted && found != listed, "{found:?}");
        for pair in depths.windows(2) {
            let keys = [nearness_key(pair[1]), nearness_key(pair[0])];
            assert_eq!(keys[0].cmp(&keys[1]), pair[0].total_cmp(&pair[1]), "{pair:?}");
        }
    }

    #[test]
    fn one_cylinder_hides_its_width_and_nothing_hides_nothing() {
        // A pixel and a half wide between two rows: three quarters of each, at an opacity of 0.8. (Strands that are wide
        // enough to show their hairs are streaked.)
        let column = through(&[16.0], 0.75, 0.8, [0.0, 0.0], 10);
        for (y, t) in column.into_iter().enumerate() {
            let expected = if (15..17).contains(&y) { 0.4 } else { 1.0 };
            assert!((t - expected).abs() < 1e-5, "row {y}: {t}");
        }
        assert_eq!(through(&[], 3.0, 0.8, [0.0, 0.0], 10), [1.0; TILE]);
    }

    #[test]
    fn a_strand_thinner_than_a_pixel_hides_its_width() {
        for y in [16.5, 16.2, 16.0] {
            let hidden: f32 = through(&[y], 0.1, 0.8, [0.0, 0.0], 10).iter().map(|t| 1.0 - t).sum();
            // A fifth of a pixel at an opacity of 0.8, wherever it lies between the pixels.
            assert!((hidden - 0.16).abs() < 1e-4, "{y}: {hidden}");
        }
    }

    #[test]
    fn a_slab_of_strands_lets_through_the_power_of_its_layers() {
        for count in [1, 5, 30] {
            let t = through(&vec![16.5; count], 2.0, 0.25, [0.0, 0.0], 10)[16];
            let expected = 0.75_f32.powi(count as i32);
            assert!((t - expected).abs() < 1e-5, "{count} layers: {t}");
        }
    }

    #[test]
    fn a_strand_on_the_border_of_two_tiles_is_drawn_once() {
        for y in [31.0, 31.8, 32.0, 32.4] {
            let above = through(&[y], 0.75, 0.8, [0.0, 0.0], 10);
            let below = through(&[y], 0.75, 0.8, [0.0, 32.0], 10);
            let hidden: f32 = above.iter().chain(&below).map(|t| 1.0 - t).sum();
            // A pixel and a half wide at an opacity of 0.8, on both sides together.
            assert!((hidden - 1.2).abs() < 1e-4, "{y}: {hidden}");
        }
    }
}
