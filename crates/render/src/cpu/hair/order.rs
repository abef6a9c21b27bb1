//! The order of segments by depth.

use lovelock_base::memory::list_bytes;
use lovelock_groom::Strands;
use rayon::prelude::*;

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

    /// Computes the depths of segments along `forward`. `first_points` are their first points.
    pub fn measure(&mut self, strands: &Strands, first_points: &[u32], forward: glam::Vec3) {
        let depth_of =
            |i: usize| strands.x[i] * forward.x + strands.y[i] * forward.y + strands.z[i] * forward.z;
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

    /// The segments of a tile from near to far: the first point in the low bits, the key above it. `segments` are indices into
    /// `first_points`.
    pub fn sort(&self, segments: &[u32], first_points: &[u32], out: &mut Vec<u64>) {
        out.clear();
        out.extend(segments.iter().map(|&segment| {
            let (key, first) = (self.keys[segment as usize], first_points[segment as usize]);
            // The inverted index puts the later segment first among equal depths; undone below.
            u64::from(key) << 32 | u64::from(u32::MAX - first)
        }));
        out.sort_unstable();
        for entry in out {
            *entry = u64::from(u32::MAX - *entry as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        keys.measure(&strands, &firsts, forward);
        let mut order = Vec::new();
        keys.sort(&firsts, &firsts, &mut order);
        let order: Vec<u32> = order.iter().map(|&entry| entry as u32).collect();
        let middle = |first: u32| 0.5 * (strands.z[first as usize] + strands.z[first as usize + 1]);
        // Keys are steps of 1/65,535 of the range of 3 m; for equal keys the later segment comes first.
        assert!(order.windows(2).all(|w| middle(w[0]) <= middle(w[1]) + 2.0 * 3.0 / 65_535.0));
        assert!(order.windows(2).any(|w| middle(w[0]) < middle(w[1]) - 0.001), "the control: depths differ");
        let mut all = order;
        all.sort_unstable();
        assert_eq!(all, firsts, "every segment once");
    }
}
