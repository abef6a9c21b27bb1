//! The fragments of all texels, sorted by texel.
//!
//! Every worker rasterises some of the strands and appends their fragments to bands of rows. A counting sort then orders each
//! band by texel. The fragments of a texel keep the order of the strands for any number of workers.

use glam::Vec3;
use rayon::prelude::*;

use super::frame::TexelFrame;
use super::lines::{Curved, Draw, Straight};
use crate::perspective::Ray;
use crate::{ProjectedStrands, ShadowInput};

/// Rows per band: its counters fit into the L1 cache.
pub(crate) const BAND_ROWS: u32 = 16;
/// Points per worker: with fewer, another worker does not pay off.
const POINTS_PER_PIECE: usize = 4096;
/// The most pieces that strands are divided into.
const MAX_PIECES: usize = 16;

/// Unsorted fragments per block. A list that doubles as it grows would hold up to twice what it needs, and three times while
/// it is moved. With blocks, only the last one of a piece and band is partly empty.
const BLOCK: usize = 256;
/// Bytes per block, including its entry in a list that doubles.
const BLOCK_BYTES: u64 =
    (BLOCK * size_of::<UnsortedFragment>() + 2 * size_of::<Vec<UnsortedFragment>>()) as u64;

/// Bytes per fragment during and after sorting, including its share of a block.
pub(crate) const BYTES_PER_FRAGMENT: u64 = BLOCK_BYTES.div_ceil(BLOCK as u64) + size_of::<Fragment>() as u64;

/// The most memory that [`Fragments`] of `resolution`² texels use for `count` fragments of `input`, bytes.
pub(crate) fn needed_bytes(input: &ShadowInput, resolution: u32, count: u64) -> u64 {
    let bands = u64::from(resolution.div_ceil(BAND_ROWS));
    let pieces = piece_count(input.strands.points()) as u64;
    let ends = 4 * bands * u64::from(BAND_ROWS * resolution);
    let begun = (pieces * bands).min(count).saturating_mul(BLOCK_BYTES);
    // The first block of a list allocates room for four.
    let lists = pieces * bands * 4 * size_of::<Vec<UnsortedFragment>>() as u64;
    count.saturating_mul(BYTES_PER_FRAGMENT).saturating_add(ends + begun + lists)
}

/// Resizes a list to exactly `len` items. The old allocation is freed before a larger one is made.
pub(crate) fn refit<T: Copy + Default>(list: &mut Vec<T>, len: usize) {
    if list.capacity() < len {
        *list = Vec::new();
        list.reserve_exact(len);
    }
    list.resize(len, T::default());
}

/// The part of a strand in a texel. Ordered by depth, then by optical depth, so that the sorted order is unique.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fragment(u64);

impl Fragment {
    /// A fragment with a depth from 0 to 1 and an optical depth. Neither may be negative.
    #[inline]
    pub fn new(depth: f32, optical_depth: f32) -> Self {
        // Non-negative floats have the order of their bits. Adding 0 turns −0 into 0.
        Self(u64::from((depth + 0.0).to_bits()) << 32 | u64::from((optical_depth + 0.0).to_bits()))
    }

    /// Depth along the light, 0 to 1 over the depth range of the hair.
    #[inline]
    pub fn depth(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    /// Optical depth.
    #[inline]
    pub fn optical_depth(self) -> f32 {
        f32::from_bits(self.0 as u32)
    }
}

/// An unsorted fragment.
#[derive(Clone, Copy, Debug)]
struct UnsortedFragment {
    /// The index of its texel in the band.
    texel: u32,
    depth: f32,
    optical_depth: f32,
}

/// The texels of one band and their fragments; see [`Fragments::bands`].
#[derive(Debug)]
pub(crate) struct Band<'a> {
    /// The end of the fragments of each texel in the whole list.
    ends: &'a [u32],
    /// The start of the fragments of the first texel.
    start: u32,
    fragments: &'a mut [Fragment],
}

impl Band<'_> {
    /// Calls `with` for each texel that has fragments, in order, with its index in the band.
    pub(crate) fn for_each_texel(&mut self, mut with: impl FnMut(usize, &mut [Fragment])) {
        let (mut rest, mut start) = (&mut *self.fragments, self.start);
        for (at, &end) in self.ends.iter().enumerate() {
            if end != start {
                let (fragments, after) = rest.split_at_mut((end - start) as usize);
                (rest, start) = (after, end);
                with(at, fragments);
            }
        }
    }
}

/// Sorts the fragments of all pieces in band `band` by texel, keeping their order. Returns the number of texels that have
/// fragments. `ends` receives the end of the fragments of each texel, counted from `start`.
fn gather(pieces: &[Piece], band: usize, start: u32, ends: &mut [u32], fragments: &mut [Fragment]) -> u64 {
    let blocks = || pieces.iter().flat_map(|piece| piece.bands[band].blocks());
    ends.fill(0);
    for block in blocks() {
        for fragment in block {
            ends[fragment.texel as usize] += 1;
        }
    }
    let (mut sum, mut in_use) = (0, 0);
    for end in &mut *ends {
        in_use += u64::from(*end != 0);
        sum += std::mem::replace(end, sum);
    }
    // Starts become ends as fragments are appended.
    for block in blocks() {
        for fragment in block {
            let at = &mut ends[fragment.texel as usize];
            fragments[*at as usize] = Fragment::new(fragment.depth, fragment.optical_depth);
            *at += 1;
        }
    }
    for end in ends {
        *end += start;
    }
    in_use
}

/// The fragments of one worker in one band, in blocks.
#[derive(Clone, Debug, Default)]
struct Blocks {
    full: Vec<Vec<UnsortedFragment>>,
    /// The last block, which is being filled.
    open: Vec<UnsortedFragment>,
    /// Empty blocks of the last build, the next one last. Empty between builds.
    spare: Vec<Vec<UnsortedFragment>>,
}

impl Blocks {
    #[inline]
    fn push(&mut self, fragment: UnsortedFragment) {
        if self.open.len() == self.open.capacity() {
            self.next();
        }
        self.open.push(fragment);
    }

    #[cold]
    fn next(&mut self) {
        let next = self.spare.pop().unwrap_or_else(|| Vec::with_capacity(BLOCK));
        let last = std::mem::replace(&mut self.open, next);
        if !last.is_empty() {
            self.full.push(last);
        }
    }

    /// Clears the list and keeps its blocks, in their order.
    fn clear(&mut self) {
        self.open.clear();
        if !self.full.is_empty() {
            self.spare = std::mem::take(&mut self.full);
            let last = std::mem::take(&mut self.open);
            self.spare.push(last);
            self.spare.iter_mut().for_each(Vec::clear);
            self.spare.reverse();
        }
    }

    /// All fragments in the order in which they were added.
    fn blocks(&self) -> impl Iterator<Item = &[UnsortedFragment]> {
        self.full.iter().chain([&self.open]).map(Vec::as_slice)
    }

    fn len(&self) -> usize {
        self.blocks().map(<[_]>::len).sum()
    }

    fn memory_bytes(&self) -> usize {
        let blocks = self.full.iter().chain([&self.open]).map(Vec::capacity).sum::<usize>();
        blocks * size_of::<UnsortedFragment>() + self.full.capacity() * size_of::<Vec<UnsortedFragment>>()
    }
}

/// The fragments of one worker per band.
#[derive(Clone, Debug, Default)]
struct Piece {
    bands: Vec<Blocks>,
}

/// The fragments of a map, or of a part of one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fragments {
    columns: u32,
    /// The end of the fragments of each texel, row after row.
    ends: Vec<u32>,
    sorted: Vec<Fragment>,
    /// Texels with fragments in each band.
    in_use: Vec<u64>,
    pieces: Vec<Piece>,
}

impl Fragments {
    /// Rasterises all strands of `input` into `rows` rows of `columns` texels. Memory is reused from build to build.
    ///
    /// There may be at most `u32::MAX` fragments.
    pub(crate) fn draw(
        &mut self,
        input: &ShadowInput,
        frame: &TexelFrame,
        (columns, rows): (u32, u32),
        draw: &impl Draw,
    ) {
        let bands = rows.div_ceil(BAND_ROWS) as usize;
        let pieces = piece_count(input.strands.points());
        self.columns = columns;
        self.pieces.resize_with(pieces, Piece::default);
        self.pieces.par_iter_mut().enumerate().with_max_len(1).for_each(|(at, piece)| {
            piece.bands.resize_with(bands, Blocks::default);
            piece.bands.iter_mut().for_each(Blocks::clear);
            let strands = first_strand(input, at, pieces)..first_strand(input, at + 1, pieces);
            let mut put = |column: u32, row: u32, depth: f32, optical_depth: f32| {
                let texel = (row % BAND_ROWS) * columns + column;
                piece.bands[(row / BAND_ROWS) as usize].push(UnsortedFragment {
                    texel,
                    depth,
                    optical_depth,
                });
            };
            draw_segments(input, frame, strands, draw, &mut put);
            piece.bands.iter_mut().for_each(|blocks| blocks.spare = Vec::new());
        });
        let pieces = &self.pieces[..];
        let count = |band: usize| pieces.iter().map(|piece| piece.bands[band].len()).sum::<usize>();
        refit(&mut self.ends, bands * (BAND_ROWS * columns) as usize);
        refit(&mut self.sorted, (0..bands).map(count).sum());
        let (mut rest, mut start) = (&mut self.sorted[..], 0);
        let ends = self.ends.chunks_exact_mut((BAND_ROWS * columns) as usize);
        let mut work = Vec::with_capacity(bands);
        for (band, ends) in ends.enumerate() {
            let (fragments, after) = std::mem::take(&mut rest).split_at_mut(count(band));
            rest = after;
            work.push((band, start, ends, fragments));
            start += count(band) as u32;
        }
        let gathered = work.into_par_iter().with_max_len(1);
        gathered
            .map(|(band, start, ends, fragments)| gather(pieces, band, start, ends, fragments))
            .collect_into_vec(&mut self.in_use);
    }

    /// The number of texels.
    pub(crate) fn texels(&self) -> usize {
        self.ends.len()
    }

    /// Texels with fragments in each band.
    pub(crate) fn in_use(&self) -> &[u64] {
        &self.in_use
    }

    /// Texels per band.
    pub(crate) fn band_texels(&self) -> usize {
        (BAND_ROWS * self.columns) as usize
    }

    /// The index of a texel.
    #[inline]
    pub(crate) fn place(&self, column: u32, row: u32) -> usize {
        (row * self.columns + column) as usize
    }

    /// The fragments of a texel.
    #[inline]
    pub(crate) fn texel(&self, texel: usize) -> &[Fragment] {
        let start = texel.checked_sub(1).map_or(0, |last| self.ends[last]);
        &self.sorted[start as usize..self.ends[texel] as usize]
    }

    /// The bands, for parallel work.
    pub(crate) fn bands(&mut self) -> Vec<Band<'_>> {
        let texels = self.band_texels();
        let (mut rest, mut start) = (&mut self.sorted[..], 0);
        let mut bands = Vec::with_capacity(self.in_use.len());
        for ends in self.ends.chunks_exact(texels) {
            let end = ends.last().copied().unwrap_or(start);
            let (fragments, after) = std::mem::take(&mut rest).split_at_mut((end - start) as usize);
            rest = after;
            bands.push(Band { ends, start, fragments });
            start = end;
        }
        bands
    }

    /// Memory of the sorted fragments, and memory that only sorting needs, bytes.
    pub(crate) fn memory_bytes(&self) -> (u64, u64) {
        let sorted = 4 * self.ends.capacity() + 8 * self.sorted.capacity();
        let loose =
            self.pieces.iter().flat_map(|piece| &piece.bands).map(Blocks::memory_bytes).sum::<usize>();
        (sorted as u64, loose as u64)
    }
}

/// Draws the valid segments of the strands `strands`.
fn draw_segments(
    input: &ShadowInput,
    frame: &TexelFrame,
    strands: std::ops::Range<usize>,
    draw: &impl Draw,
    put: &mut impl FnMut(u32, u32, f32, f32),
) {
    match &input.projected {
        None => for_each_segment(input, frame, strands, |from, to, _| draw.draw(from, to, &Straight, put)),
        Some(projected) => for_each_segment(input, frame, strands, |from, to, first| {
            draw.draw(from, to, &curved(input, frame, projected, first), put);
        }),
    }
}

/// The segment between the points `first` and `first + 1` of projected strands.
pub(crate) fn curved(
    input: &ShadowInput,
    frame: &TexelFrame,
    projected: &ProjectedStrands,
    first: usize,
) -> Curved {
    let ends = [first, first + 1].map(|point| input.strands.point(point));
    // The axes of projected strands are those of their coordinates.
    Curved {
        ray: Ray::new(projected, ends, first),
        per_metre: 1.0 / frame.depth_range,
        first: frame.anchor_depth,
    }
}

/// Calls `with` with both ends, in texel coordinates, of each valid segment of the strands `strands`, and the index of its first point.
pub(crate) fn for_each_segment(
    input: &ShadowInput,
    frame: &TexelFrame,
    strands: std::ops::Range<usize>,
    mut with: impl FnMut(Vec3, Vec3, usize),
) {
    let axes = frame.axes();
    for strand in strands {
        let points =
            input.strands.first_point[strand] as usize..input.strands.first_point[strand + 1] as usize;
        let mut last = None;
        for point in points {
            let p = axes.transform(input.strands.point(point));
            let p = frame.holds(p).then(|| frame.held(p));
            if let (Some(from), Some(to)) = (last, p) {
                with(from, to, point - 1);
            }
            last = p;
        }
    }
}

/// The sum of `of` over the ends of all segments.
pub(crate) fn sum_over_segments(
    input: &ShadowInput,
    frame: &TexelFrame,
    of: impl Fn(Vec3, Vec3) -> u64 + Sync,
) -> u64 {
    let pieces = piece_count(input.strands.points());
    let sum = |piece: usize| {
        let strands = first_strand(input, piece, pieces)..first_strand(input, piece + 1, pieces);
        let mut sum = 0_u64;
        for_each_segment(input, frame, strands, |from, to, _| sum = sum.saturating_add(of(from, to)));
        sum
    };
    (0..pieces).into_par_iter().with_max_len(1).map(sum).reduce(|| 0, u64::saturating_add)
}

/// The number of pieces to divide strands into in the current thread pool.
fn piece_count(points: usize) -> usize {
    (2 * rayon::current_num_threads()).min(points / POINTS_PER_PIECE).clamp(1, MAX_PIECES)
}

/// The first strand of piece `piece` of `pieces`, which have about the same number of points.
fn first_strand(input: &ShadowInput, piece: usize, pieces: usize) -> usize {
    let strands = input.strands;
    if piece == pieces {
        return strands.count();
    }
    let point = (strands.points() as u64 * piece as u64 / pieces as u64) as u32;
    strands.first_point.partition_point(|first| *first < point).min(strands.count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fragments_are_ordered_by_depth_then_by_optical_depth() {
        let mut fragments = [(0.5, 0.1), (0.25, 3.0), (0.0, 0.2), (0.5, 0.05), (1.0, 0.0), (-0.0, 0.1)]
            .map(|(depth, optical)| Fragment::new(depth, optical));
        fragments.sort_unstable();
        let found = fragments.map(|f| (f.depth(), f.optical_depth()));
        assert_eq!(found, [(0.0, 0.1), (0.0, 0.2), (0.25, 3.0), (0.5, 0.05), (0.5, 0.1), (1.0, 0.0)]);
    }

    #[test]
    fn gathering_sorts_by_texel_and_keeps_the_order() {
        let piece = |texels: &[u32], base: f32| Piece {
            bands: vec![Blocks {
                full: Vec::new(),
                spare: Vec::new(),
                open: texels
                    .iter()
                    .enumerate()
                    .map(|(i, t)| UnsortedFragment { texel: *t, depth: base + i as f32, optical_depth: 1.0 })
                    .collect(),
            }],
        };
        let pieces = [piece(&[3, 0, 3, 4], 0.0), piece(&[0, 3, 3], 10.0)];
        let (mut ends, mut fragments) = ([9; 5], [Fragment::new(7.0, 7.0); 7]);
        assert_eq!(gather(&pieces, 0, 100, &mut ends, &mut fragments), 3);
        assert_eq!(ends, [102, 102, 102, 106, 107]);
        assert_eq!(fragments.map(Fragment::depth), [1.0, 10.0, 0.0, 2.0, 11.0, 12.0, 3.0]);
        let mut band = Band { ends: &ends, start: 100, fragments: &mut fragments };
        let mut seen = Vec::new();
        band.for_each_texel(|texel, fragments| seen.push((texel, fragments.len())));
        assert_eq!(seen, [(0, 2), (3, 4), (4, 1)]);
    }
}
