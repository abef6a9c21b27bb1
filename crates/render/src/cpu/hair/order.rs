//! The order of segments by depth.

use lovelock_base::memory::list_bytes;
use lovelock_groom::Strands;
use rayon::prelude::*;

use crate::cpu::math::{max, min};
use crate::cpu::strand_points::ShadedPoint;

/// The depth and the index of a segment in one number: smaller is nearer; for equal depth, the larger index is nearer.
///
/// The reverse of the far-to-near order of `DepthSort`: the same 16 bits of depth, and ties reversed.
#[derive(Clone, Debug, Default)]
pub(crate) struct SegmentKeys {
    keys: Vec<u16>,
}

/// Segments per task at least.
const PIECE: usize = 8192;

impl SegmentKeys {
    /// Their memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.keys)
    }

    /// Computes the depths of segments along `forward`. `first_points` are their first points. Points from a number on are those of other
    /// strands, if there are `more`.
    pub fn measure(
        &mut self,
        strands: &Strands,
        more: Option<(usize, &Strands)>,
        first_points: &[u32],
        forward: glam::Vec3,
    ) {
        let of = |strands: &Strands, i: usize| {
            strands.x[i] * forward.x + strands.y[i] * forward.y + strands.z[i] * forward.z
        };
        match more {
            None => self.measure_by(first_points, |i| of(strands, i)),
            Some((from, more)) => {
                self.measure_by(first_points, |i| if i < from { of(strands, i) } else { of(more, i - from) });
            }
        }
    }

    fn measure_by(&mut self, first_points: &[u32], depth_of: impl Fn(usize) -> f32 + Sync) {
        let middle = |&first: &u32| {
            let depth = 0.5 * (depth_of(first as usize) + depth_of(first as usize + 1));
            if depth.is_finite() { depth } else { 0.0 }
        };
        let (near, far) = first_points
            .par_chunks(PIECE)
            .map(|piece| {
                piece.iter().map(middle).fold((f32::INFINITY, f32::NEG_INFINITY), |(near, far), d| {
                    (if d < near { d } else { near }, if d > far { d } else { far })
                })
            })
            .reduce(|| (f32::INFINITY, f32::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        let scale = if far > near { 65535.0 / (far - near) } else { 0.0 };
        first_points
            .par_iter()
            .with_min_len(PIECE)
            .map(|first| u16::MAX - ((far - middle(first)) * scale) as u16)
            .collect_into_vec(&mut self.keys);
    }

    /// Passes the segments of a tile to `draw` from near to far, in pieces, until it returns false: as the numbers
    /// of their first points. `segments` are indices into `first_points`. What is not drawn, because a tile is opaque before, is not sorted.
    pub fn each_piece(
        &self,
        segments: &[u32],
        first_points: &[u32],
        scratch: &mut Pieces,
        mut draw: impl FnMut(&[u64]) -> bool,
    ) {
        let Pieces { entries, ordered } = scratch;
        entries.clear();
        entries.extend(segments.iter().map(|&segment| {
            let (key, first) = (self.keys[segment as usize], first_points[segment as usize]);
            // The inverted index puts the later segment first among equal depths; undone below.
            u64::from(key) << 32 | u64::from(u32::MAX - first)
        }));
        let piece_of = |entry: u64| (entry >> (32 + PIECE_BITS)) as usize;
        let mut ends = [0_usize; PIECES];
        for &entry in entries.iter() {
            ends[piece_of(entry)] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            (*end, sum) = (sum, sum + *end);
        }
        ordered.resize(entries.len(), 0);
        // Each start advances to the end of its piece.
        for &entry in entries.iter() {
            let slot = &mut ends[piece_of(entry)];
            ordered[*slot] = entry;
            *slot += 1;
        }
        let mut start = 0;
        for end in ends {
            let piece = &mut ordered[start..end];
            start = end;
            if piece.is_empty() {
                continue;
            }
            piece.sort_unstable();
            for entry in &mut *piece {
                *entry = u64::from(u32::MAX - *entry as u32);
            }
            if !draw(piece) {
                return;
            }
        }
    }
}

/// Bits of a key within a piece, and the number of pieces.
const PIECE_BITS: u32 = 8;
const PIECES: usize = 1 << (16 - PIECE_BITS);

/// Scratch memory of [`SegmentKeys::each_piece`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Pieces {
    entries: Vec<u64>,
    ordered: Vec<u64>,
}

impl Pieces {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.entries) + list_bytes(&self.ordered)
    }
}

/// The segments of a tile, those with nearer ends first. Scratch memory.
///
/// They are divided into pieces by depth and not sorted within them: whoever lists fragments sorts those, and a segment reaches over several
/// pieces anyway.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearFirst {
    /// The depth of the nearer end of each segment.
    depths: Vec<f32>,
    ordered: Vec<u32>,
}

impl NearFirst {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.depths) + list_bytes(&self.ordered)
    }

    /// Orders `segments`, which are indices into `first_points`.
    pub fn order(&mut self, segments: &[u32], first_points: &[u32], points: &[ShadedPoint]) -> &[u32] {
        let Self { depths, ordered } = self;
        depths.clear();
        depths.extend(segments.iter().map(|&segment| {
            let first = first_points[segment as usize] as usize;
            max(points[first].depth, points[first + 1].depth)
        }));
        let (far, near) = depths
            .iter()
            .fold((f32::INFINITY, 0.0), |(far, near), &depth| (min(far, depth), max(near, depth)));
        let scale = if near > far { PIECES as f32 / (near - far) } else { 0.0 };
        // The farthest depth belongs to the last piece.
        let piece_of = |depth: f32| (((near - depth) * scale) as usize).min(PIECES - 1);
        let mut ends = [0_usize; PIECES];
        for &depth in depths.iter() {
            ends[piece_of(depth)] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            (*end, sum) = (sum, sum + *end);
        }
        ordered.resize(segments.len(), 0);
        // Each start advances to the end of its piece.
        for (&segment, &depth) in segments.iter().zip(depths.iter()) {
            let slot = &mut ends[piece_of(depth)];
            ordered[*slot] = segment;
            *slot += 1;
        }
        ordered
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_with_nearer_ends_come_first() {
        let depth = |i: u32| 0.1 + 0.8 * ((i * 7919) % 2000) as f32 / 2000.0;
        let points: Vec<_> =
            (0..2000).map(|i| ShadedPoint { depth: depth(i), ..ShadedPoint::default() }).collect();
        let first_points: Vec<u32> = (0..1000).map(|segment| 2 * segment).collect();
        // A tile with every third segment.
        let segments: Vec<u32> = (0..1000).step_by(3).collect();
        let nearer = |segment: u32| depth(2 * segment).max(depth(2 * segment + 1));
        let mut near_first = NearFirst::default();
        let mut found = near_first.order(&segments, &first_points, &points).to_vec();
        let step = 0.8 / PIECES as f32;
        assert!(found.windows(2).all(|pair| nearer(pair[0]) >= nearer(pair[1]) - 1.01 * step));
        assert!(found.windows(2).any(|pair| nearer(pair[0]) > nearer(pair[1]) + 0.001), "the control");
        found.sort_unstable();
        assert_eq!(found, segments, "every segment once");
        assert_eq!(near_first.order(&[7], &first_points, &points), [7]);
        assert!(near_first.order(&[], &first_points, &points).is_empty());
    }

    #[test]
    fn the_nearest_middle_comes_first() {
        let mut strands = Strands::default();
        for i in 0..2000 {
            strands.x.push(0.0);
            strands.y.push(0.0);
            strands.z.push(((i * 7919) % 300) as f32 * 0.01);
        }
        let firsts: Vec<u32> = (0..1999).collect();
        let forward = glam::Vec3::Z;
        let mut keys = SegmentKeys::default();
        keys.measure(&strands, None, &firsts, forward);
        let (mut order, mut pieces) = (Vec::new(), Vec::new());
        keys.each_piece(&firsts, &firsts, &mut Pieces::default(), |piece| {
            order.extend(piece.iter().map(|&entry| entry as u32));
            pieces.push(piece.len());
            true
        });
        assert!(pieces.len() > 50, "{pieces:?}");
        let middle = |first: u32| 0.5 * (strands.z[first as usize] + strands.z[first as usize + 1]);
        // Keys are steps of 1/65,535 of the range of 3 m; for equal keys the later segment comes first.
        assert!(order.windows(2).all(|w| middle(w[0]) <= middle(w[1]) + 2.0 * 3.0 / 65_535.0));
        assert!(order.windows(2).any(|w| middle(w[0]) < middle(w[1]) - 0.001), "the control: depths differ");
        let mut some = 0;
        keys.each_piece(&firsts, &firsts, &mut Pieces::default(), |piece| {
            some += piece.len();
            some < 500
        });
        assert!((500..1000).contains(&some), "no piece after the last that is drawn: {some}");
        let mut all = order;
        all.sort_unstable();
        assert_eq!(all, firsts, "every segment once");
    }
}
