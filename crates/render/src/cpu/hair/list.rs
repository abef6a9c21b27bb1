//! All fragments of a tile, per pixel.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use std::cmp::Ordering;
use std::hint::black_box;

use glam::Vec4;
use lovelock_base::memory::list_bytes;
use lovelock_base::simd_versions;

use super::blend::FETCHED;
use super::fragments::{Span, SpanSink, each_span};
use super::opaque_depths::OpaqueDepths;
use crate::cpu::math::{clamp, floor, max};
use crate::cpu::strand_points::ShadedPoint;
use crate::cpu::surface::raster::{Occlusion, SurfaceSamples};
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
    #[inline(always)]
    pub fn opacity(&self) -> f32 {
        opacity_of(self.alpha, self.seen)
    }
}

/// See [`Fragment::opacity`].
#[inline(always)]
fn opacity_of(alpha: f32, seen: u32) -> f32 {
    alpha * 0.25 * seen.count_ones() as f32
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
    /// The segments to list, as indices into `first_points`.
    pub segments: &'a [u32],
    pub first_points: &'a [u32],
    pub samples: &'a SurfaceSamples,
    /// What `samples` hide.
    pub hidden: &'a Occlusion,
    /// Opacity of a strand where it covers a pixel completely.
    pub opacity: f32,
    /// Whether the samples that fragments cover are used.
    pub takes_samples: bool,
}

simd_versions! {
    /// [`list_segments`] for the vectors of `width`.
    pub(crate) fn list_segments_simd(
        input: &ListTile, opaque: Option<&mut OpaqueDepths>, out: &mut Fragments
    ) -> () {
        list_segments(input, opaque, out)
    }
}

/// Lists the fragments of segments in the pixels of a tile: all, or with `opaque` those that are seen where all fragments are blended from
/// near to far.
#[inline(always)]
fn list_segments(input: &ListTile, opaque: Option<&mut OpaqueDepths>, out: &mut Fragments) {
    let mut sink = List { input, opaque, found: &mut out.found, nearer: 0.0 };
    for segments in input.segments.chunks(FETCHED) {
        let ends = segments.iter().map(|&segment| {
            let first = input.first_points[segment as usize] as usize;
            (&input.points[first], &input.points[first + 1])
        });
        // Points lie in the order of strands. These loads do not wait for each other, as those below would.
        black_box(ends.clone().map(|(a, b)| a.x + b.hash).sum::<f32>());
        for (a, b) in ends {
            sink.nearer = max(a.depth, b.depth);
            if sink.opaque.as_ref().is_none_or(|opaque| opaque.shows(sink.nearer)) {
                each_span(a, b, input.origin, input.opacity, &mut sink);
            }
        }
    }
}

struct List<'a> {
    input: &'a ListTile<'a>,
    /// Where pixels are opaque, if only fragments are listed that are seen.
    opaque: Option<&'a mut OpaqueDepths>,
    found: &'a mut Vec<(u32, Fragment)>,
    /// The depth of the nearer end of the segment.
    nearer: f32,
}

/// The bits of a fragment that is in front of the body in all samples.
const ALL_SEEN: u32 = 0b1111;

impl List<'_> {
    /// The samples in which the pixels of a span are in front of the body, see [`Fragment::seen`], and its opacity in them.
    #[inline(always)]
    fn seen(&self, span: &Span) -> ([u32; BLOCK_LANES], [f32; BLOCK_LANES]) {
        let near = &self.input.hidden.near[span.block];
        let mut is_in_front = true;
        for from in (0..BLOCK_LANES).step_by(4) {
            let four = |of: &[f32; BLOCK_LANES]| Vec4::from_slice(&of[from..from + 4]);
            is_in_front &= four(&span.depth).cmpge(four(near)).all();
        }
        if is_in_front {
            return ([ALL_SEEN; BLOCK_LANES], span.alpha);
        }
        let (left, top) = pixel_of(span.block, 0);
        let (mut seen, mut opacity) = ([0; BLOCK_LANES], [0.0; BLOCK_LANES]);
        for lane in 0..BLOCK_LANES {
            let at = (top + lane / BLOCK_WIDTH) * STRIDE + left + lane % BLOCK_WIDTH;
            for (sample, body) in self.input.samples.depths(at).into_iter().enumerate() {
                seen[lane] |= u32::from(span.depth[lane] >= body) << sample;
            }
            opacity[lane] = opacity_of(span.alpha[lane], seen[lane]);
        }
        (seen, opacity)
    }
}

impl SpanSink for List<'_> {
    #[inline(always)]
    fn is_row_open(&self, row: usize) -> bool {
        self.opaque.as_ref().is_none_or(|opaque| opaque.shows_in_row(row, self.nearer))
    }

    #[inline(always)]
    fn is_open(&self, block: usize) -> bool {
        self.opaque.as_ref().is_none_or(|opaque| opaque.shows_in_block(block, self.nearer))
    }

    #[inline(always)]
    fn take(&mut self, a: &ShadedPoint, b: &ShadedPoint, span: &Span) {
        let (left, top) = pixel_of(span.block, 0);
        let (seen, mut opacity) = self.seen(span);
        if let Some(opaque) = &mut self.opaque {
            opaque.admit(span, &mut opacity);
        }
        // One bit per lane, so that lanes without a fragment cost no branch each.
        let mut listed = 0_u32;
        for from in (0..BLOCK_LANES).step_by(4) {
            listed |= Vec4::from_slice(&opacity[from..from + 4]).cmpgt(Vec4::ZERO).bitmask() << from;
        }
        if listed == 0 {
            return;
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
        if self.input.takes_samples {
            let origin = self.input.origin;
            for lane in 0..BLOCK_LANES {
                let (x, y) = (left + lane % BLOCK_WIDTH, top + lane / BLOCK_WIDTH);
                let pixel = [origin[0] + x as f32, origin[1] + y as f32];
                covered[lane] = covered_samples(span.alpha[lane], pixel, a.hash);
            }
        }
        while listed != 0 {
            let lane = listed.trailing_zeros() as usize % BLOCK_LANES;
            listed &= listed - 1;
            let at = (top + lane / BLOCK_WIDTH) * STRIDE + left + lane % BLOCK_WIDTH;
            let color = [colors[0][lane], colors[1][lane], colors[2][lane]];
            let (depth, alpha) = (span.depth[lane], span.alpha[lane]);
            let (seen, covered) = (seen[lane], covered[lane]);
            self.found.push((at as u32, Fragment { depth, alpha, color, seen, covered }));
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
    use lovelock_base::simd::Width;

    use super::*;
    use crate::Transparency;
    use crate::cpu::hair::order::NearFirst;
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
        let (samples, hidden) = (Box::<SurfaceSamples>::default(), Occlusion::default());
        let input = ListTile {
            origin,
            points: &points,
            segments: &segments,
            first_points: &first_points,
            samples: &samples,
            hidden: &hidden,
            opacity,
            takes_samples: false,
        };
        let mut fragments = Fragments::default();
        list_segments(&input, None, &mut fragments);
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

    /// Strands across a tile in depths without an order, with the first point of each.
    fn crossing_strands(count: u32) -> (Vec<ShadedPoint>, Vec<u32>) {
        let noise = |i: u32, salt: u32| {
            let bits =
                (i.wrapping_mul(0x9e37_79b9) ^ salt.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35);
            (bits >> 8) as f32 / (1 << 24) as f32
        };
        let point = |i: u32| ShadedPoint {
            x: 36.0 * noise(i, 1) - 2.0,
            y: 36.0 * (i % 2) as f32 - 2.0,
            depth: 0.1 + 0.8 * noise(i / 2, 2) + 0.05 * noise(i, 3),
            half_width: 0.1 + 1.5 * noise(i / 2, 4),
            run_x: 0.0,
            run_y: 1.0,
            color: [noise(i, 5), noise(i, 6), noise(i, 7)],
            hash: noise(i / 2, 8),
        };
        ((0..2 * count).map(point).collect(), (0..count).map(|strand| 2 * strand).collect())
    }

    #[test]
    fn fragments_behind_opaque_pixels_are_left_out_and_change_nothing() {
        let (points, first_points) = crossing_strands(3000);
        let in_turn: Vec<u32> = (0..3000).collect();
        let near_first = NearFirst::default().order(&in_turn, &first_points, &points).to_vec();
        // A wall before some samples of the upper half of the tile.
        let (mut samples, mut hidden) = (Box::<SurfaceSamples>::default(), Occlusion::default());
        for (i, depth) in samples.depth.iter_mut().enumerate().take(TILE / 2 * STRIDE * 4) {
            *depth = if i % 3 == 0 { 0.6 } else { 0.0 };
        }
        hidden.gather(&samples);
        let tile = |segments| ListTile {
            origin: [0.0, 0.0],
            points: &points,
            segments,
            first_points: &first_points,
            samples: &samples,
            hidden: &hidden,
            opacity: 0.4,
            takes_samples: false,
        };
        let layers = |fragments: &mut Fragments| {
            let mut layers = Vec::new();
            fragments.each_pixel(|at, of| layers.push((at, resolve(Transparency::Exact, of))));
            layers
        };
        let mut all = Fragments::default();
        list_segments(&tile(&in_turn), None, &mut all);
        let wanted = layers(&mut all);
        assert!(wanted.iter().all(|(_, layer)| layer.through < 0.1), "control: hair covers the tile");
        let mut opaque = OpaqueDepths::default();
        for (segments, most) in [(&near_first, 0.6), (&in_turn, 1.0)] {
            for &width in Width::ALL.iter().filter(|width| width.is_available()) {
                let mut seen = Fragments::default();
                opaque.clear();
                list_segments_simd(width.for_eight(), &tile(segments), Some(&mut opaque), &mut seen);
                let share = seen.found.len() as f32 / all.found.len() as f32;
                println!("{width:?}: {share} of the fragments are listed");
                assert!(share < most, "{width:?}: {share}");
                assert!(layers(&mut seen) == wanted, "{width:?}, {share}");
            }
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
