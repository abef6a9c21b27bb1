//! The fragments of all texels, sorted by texel.
//!
//! Every worker draws strands of its own and puts their fragments into bands of rows. Each band is then sorted by
//! texel, by counting. Within a texel, fragments lie in the order of the strands, whatever the number of workers.

use rayon::prelude::*;

use super::frame::TexelFrame;
use super::lines::Draw;
use crate::ShadowInput;

/// Rows of a band: its counters fit into the processor's first cache.
pub(crate) const BAND_ROWS: u32 = 16;
/// Points that are worth a worker of their own.
const POINTS_PER_PIECE: usize = 4096;
/// Most pieces that strands are cut into.
const MOST_PIECES: usize = 16;

/// Bytes that one fragment takes while it is sorted and after.
pub(crate) const BYTES_PER_FRAGMENT: u64 = (size_of::<Loose>() + size_of::<Fragment>()) as u64;

/// What a strand leaves in a texel. Ordered by depth first, then by optical depth, so that sorting leaves no choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fragment(u64);

impl Fragment {
    /// A fragment at a depth of 0 to 1 with an optical depth; neither may be negative.
    #[inline]
    pub fn new(depth: f32, optical_depth: f32) -> Self {
        // Floats that are not negative are ordered as their bits. Adding 0 turns −0 into 0.
        Self(u64::from((depth + 0.0).to_bits()) << 32 | u64::from((optical_depth + 0.0).to_bits()))
    }

    /// Depth along the light, 0 to 1 over the hair's range.
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

/// A fragment on its way to its texel.
#[derive(Clone, Copy, Debug)]
struct Loose {
    /// Its texel within the band.
    texel: u32,
    depth: f32,
    optical_depth: f32,
}

/// Rows of texels with their fragments.
#[derive(Clone, Debug, Default)]
pub(crate) struct Band {
    /// Where the fragments of each texel begin, and one more: where the last ones end.
    starts: Vec<u32>,
    fragments: Vec<Fragment>,
}

impl Band {
    /// The texels of the band.
    pub(crate) fn texels(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The fragments of a texel.
    #[inline]
    pub(crate) fn texel(&self, texel: usize) -> &[Fragment] {
        &self.fragments[self.starts[texel] as usize..self.starts[texel + 1] as usize]
    }

    /// Calls `with` for each texel that has fragments, in order.
    pub(crate) fn for_each_texel(&mut self, mut with: impl FnMut(usize, &mut [Fragment])) {
        let mut rest = &mut self.fragments[..];
        for (texel, ends) in self.starts.windows(2).enumerate() {
            if ends[0] != ends[1] {
                let (fragments, after) = rest.split_at_mut((ends[1] - ends[0]) as usize);
                rest = after;
                with(texel, fragments);
            }
        }
    }

    /// Texels with fragments.
    pub(crate) fn texels_in_use(&self) -> u64 {
        self.starts.windows(2).filter(|ends| ends[0] != ends[1]).count() as u64
    }

    /// Takes the fragments that pieces have for this band and sorts them by texel, keeping their order.
    fn gather(&mut self, texels: usize, pieces: &[Piece], band: usize) {
        self.starts.clear();
        self.starts.resize(texels + 1, 0);
        let loose = || pieces.iter().flat_map(|piece| &piece.bands[band]);
        for fragment in loose() {
            self.starts[fragment.texel as usize] += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += std::mem::replace(start, sum);
        }
        self.fragments.clear();
        self.fragments.resize(sum as usize, Fragment::default());
        for fragment in loose() {
            let at = &mut self.starts[fragment.texel as usize];
            self.fragments[*at as usize] = Fragment::new(fragment.depth, fragment.optical_depth);
            *at += 1;
        }
        // Each start has moved to the end of its texel, which is the next one's start.
        self.starts.copy_within(..texels, 1);
        self.starts[0] = 0;
    }
}

/// One worker's fragments by band.
#[derive(Clone, Debug, Default)]
struct Piece {
    bands: Vec<Vec<Loose>>,
}

/// The fragments of a map, or of a part of one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fragments {
    pub(crate) bands: Vec<Band>,
    columns: u32,
    pieces: Vec<Piece>,
    /// Segments that were drawn.
    pub(crate) segments: u64,
}

impl Fragments {
    /// Draws all strands of `input` into `rows` rows of `columns` texels. Memory is kept from time to time.
    ///
    /// At most `u32::MAX` fragments may come of it.
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
        self.segments = self
            .pieces
            .par_iter_mut()
            .enumerate()
            .with_max_len(1)
            .map(|(at, piece)| {
                piece.bands.resize_with(bands, Vec::new);
                piece.bands.iter_mut().for_each(Vec::clear);
                let strands = first_strand(input, at, pieces)..first_strand(input, at + 1, pieces);
                let mut put = |column: u32, row: u32, depth: f32, optical_depth: f32| {
                    let texel = (row % BAND_ROWS) * columns + column;
                    piece.bands[(row / BAND_ROWS) as usize].push(Loose { texel, depth, optical_depth });
                };
                for_each_segment(input, frame, strands, |from, to| draw.draw(from, to, &mut put))
            })
            .sum();
        self.bands.resize_with(bands, Band::default);
        let pieces = &self.pieces[..];
        let texels = (BAND_ROWS * columns) as usize;
        self.bands
            .par_iter_mut()
            .enumerate()
            .with_max_len(1)
            .for_each(|(at, band)| band.gather(texels, pieces, at));
    }

    /// Band and texel within it of a column and a row.
    #[inline]
    pub(crate) fn place(&self, column: u32, row: u32) -> (usize, usize) {
        ((row / BAND_ROWS) as usize, ((row % BAND_ROWS) * self.columns + column) as usize)
    }

    /// Memory of the sorted fragments, and of what only sorting needs, bytes.
    pub(crate) fn memory_bytes(&self) -> (u64, u64) {
        let bands = self.bands.iter().map(|band| 4 * band.starts.capacity() + 8 * band.fragments.capacity());
        let loose = self.pieces.iter().flat_map(|piece| &piece.bands);
        let loose = loose.map(|loose| size_of::<Loose>() * loose.capacity());
        (bands.sum::<usize>() as u64, loose.sum::<usize>() as u64)
    }
}

/// Calls `with` for both ends, in texel coordinates, of each segment of the strands `strands` that is whole. Says how
/// many these are.
pub(crate) fn for_each_segment(
    input: &ShadowInput,
    frame: &TexelFrame,
    strands: std::ops::Range<usize>,
    mut with: impl FnMut(glam::Vec3, glam::Vec3),
) -> u64 {
    let axes = frame.axes();
    let mut count = 0;
    for strand in strands {
        let points =
            input.strands.first_point[strand] as usize..input.strands.first_point[strand + 1] as usize;
        let mut last = None;
        for point in points {
            let p = axes.transform(input.strands.point(point));
            let p = frame.holds(p).then(|| frame.held(p));
            if let (Some(from), Some(to)) = (last, p) {
                count += 1;
                with(from, to);
            }
            last = p;
        }
    }
    count
}

/// The sum over all segments of what `of` makes of their ends.
pub(crate) fn sum_over_segments(
    input: &ShadowInput,
    frame: &TexelFrame,
    of: impl Fn(glam::Vec3, glam::Vec3) -> u64 + Sync,
) -> u64 {
    let pieces = piece_count(input.strands.points());
    let sum = |piece: usize| {
        let strands = first_strand(input, piece, pieces)..first_strand(input, piece + 1, pieces);
        let mut sum = 0_u64;
        for_each_segment(input, frame, strands, |from, to| sum = sum.saturating_add(of(from, to)));
        sum
    };
    (0..pieces).into_par_iter().with_max_len(1).map(sum).reduce(|| 0, u64::saturating_add)
}

/// How many pieces to cut strands into here and now.
fn piece_count(points: usize) -> usize {
    (2 * rayon::current_num_threads()).min(points / POINTS_PER_PIECE).clamp(1, MOST_PIECES)
}

/// The strand at which piece `piece` of `pieces` begins: pieces have about equally many points.
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
            bands: vec![
                texels
                    .iter()
                    .enumerate()
                    .map(|(i, t)| Loose { texel: *t, depth: base + i as f32, optical_depth: 1.0 })
                    .collect(),
            ],
        };
        let mut band = Band::default();
        for _ in 0..2 {
            band.gather(5, &[piece(&[3, 0, 3, 4], 0.0), piece(&[0, 3, 3], 10.0)], 0);
            let depths = |texel| band.texel(texel).iter().map(|f| f.depth()).collect::<Vec<_>>();
            assert_eq!(depths(0), [1.0, 10.0]);
            assert_eq!(depths(3), [0.0, 2.0, 11.0, 12.0]);
            assert_eq!(depths(4), [3.0]);
            assert!(depths(1).is_empty() && depths(2).is_empty());
            assert_eq!((band.texels(), band.texels_in_use()), (5, 3));
            let mut seen = Vec::new();
            band.for_each_texel(|texel, fragments| seen.push((texel, fragments.len())));
            assert_eq!(seen, [(0, 2), (3, 4), (4, 1)]);
        }
    }
}
