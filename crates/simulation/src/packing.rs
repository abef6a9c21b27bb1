//! The assignment of guides to the lanes of blocks.
//!
//! The three guides of a wisp take three consecutive lanes, so that the solver can treat them as one lock: a
//! block holds five locks and leaves its last lane empty. Guides that belong to no wisp of three guides of its
//! own, as in hair files with one guide per wisp, fill blocks of sixteen.

use glam::Vec3;
use lovelock_groom::{Guides, Wisp};

use crate::lanes::{LANES, Lane, Lane3, ZERO3};

/// Guides per lock.
pub(crate) const LOCK: usize = 3;

/// Locks per block.
pub(crate) const LOCKS: usize = LANES / LOCK;

/// The guides of one block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Lanes {
    /// The guide in each lane. Lanes from `used` on repeat the last guide.
    pub(crate) guides: [u32; LANES],
    pub(crate) used: usize,
    /// The first `3 * locks` lanes hold whole locks.
    pub(crate) locks: usize,
}

/// The row with each lane replaced by the next lane of the same lock, in a circle; the last lane, which belongs to none,
/// stays. Written out, because the compiler makes one permutation of it, and gathers of a loop.
#[inline(always)]
fn next_in_lock(a: &Lane) -> Lane {
    Lane([
        a[1], a[2], a[0], a[4], a[5], a[3], a[7], a[8], a[6], a[10], a[11], a[9], a[13], a[14], a[12], a[15],
    ])
}

/// The row with each lane replaced by the lane before it in the same lock.
#[inline(always)]
fn last_in_lock(a: &Lane) -> Lane {
    Lane([
        a[2], a[0], a[1], a[5], a[3], a[4], a[8], a[6], a[7], a[11], a[9], a[10], a[14], a[12], a[13], a[15],
    ])
}

/// The mean over the lanes of each lock. Lanes that hold no lock contain numbers without a meaning.
#[inline(always)]
pub(crate) fn mean_of_lock(row: &Lane3) -> Lane3 {
    let mut mean = ZERO3;
    for (mean, of) in mean.iter_mut().zip(row) {
        *mean = of.plus(next_in_lock(of)).plus(last_in_lock(of)).times(Lane::splat(1.0 / LOCK as f32));
    }
    mean
}

/// Groups the guides into blocks, in the order of a Morton curve through their roots, so that neighbours on
/// the scalp are neighbours in memory.
pub(crate) fn pack(guides: &Guides, wisps: &[Wisp]) -> Vec<Lanes> {
    let count = guides.count();
    let root = |g: u32| guides.point(g as usize, 0);
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for p in (0..count as u32).map(root) {
        (min, max) = (min.min(p), max.max(p));
    }
    let scale = 1023.0 / (max - min).max_element().max(1e-6);
    let code = |p: Vec3| morton((p - min) * scale);
    let mut taken = vec![false; count];
    let mut locks: Vec<(u32, [u32; LOCK])> = Vec::new();
    for wisp in wisps {
        let [a, b, c] = wisp.guides;
        let free = wisp.guides.iter().all(|&g| taken.get(g as usize) == Some(&false));
        if free && a != b && b != c && c != a {
            wisp.guides.iter().for_each(|&g| taken[g as usize] = true);
            let middle = wisp.guides.iter().map(|&g| root(g)).sum::<Vec3>() / LOCK as f32;
            locks.push((code(middle), wisp.guides));
        }
    }
    let mut single: Vec<(u32, u32)> =
        (0..count as u32).filter(|&g| !taken[g as usize]).map(|g| (code(root(g)), g)).collect();
    locks.sort_unstable();
    single.sort_unstable();
    let of_locks = locks.chunks(LOCKS).map(|chunk| {
        let guides: Vec<u32> = chunk.iter().flat_map(|lock| lock.1).collect();
        Lanes { locks: chunk.len(), ..lanes_of(&guides) }
    });
    let of_single = single.chunks(LANES).map(|chunk| {
        let guides: Vec<u32> = chunk.iter().map(|guide| guide.1).collect();
        lanes_of(&guides)
    });
    of_locks.chain(of_single).collect()
}

/// A block of single guides.
fn lanes_of(guides: &[u32]) -> Lanes {
    let mut lanes = [guides[guides.len() - 1]; LANES];
    lanes[..guides.len()].copy_from_slice(guides);
    Lanes { guides: lanes, used: guides.len(), locks: 0 }
}

/// Interleaves ten bits of each coordinate.
fn morton(p: Vec3) -> u32 {
    let spread = |v: f32| (0..10).fold(0_u32, |m, bit| m | (((v as u32 >> bit) & 1) << (3 * bit)));
    spread(p.x) | (spread(p.y) << 1) | (spread(p.z) << 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{at, put};

    fn guides(count: u32) -> Guides {
        let mut guides = Guides { points_per_guide: 2, ..Guides::default() };
        for g in 0..count {
            let p = Vec3::new((g * 7 % count) as f32, (g * 11 % count) as f32, 0.0);
            guides.push(&[p, p + Vec3::Y]);
        }
        guides
    }

    fn wisp(guides: [u32; 3]) -> Wisp {
        Wisp { guides, first_strand: 0, strand_count: 0 }
    }

    #[test]
    fn every_guide_is_in_one_block_and_the_rest_repeats() {
        let wisps: Vec<Wisp> = (0..7).map(|w| wisp([3 * w, 3 * w + 1, 3 * w + 2])).collect();
        for (wisps, locks) in [(&wisps[..0], 0), (&wisps[..], 7)] {
            let blocks = pack(&guides(37), wisps);
            let mut seen: Vec<u32> = blocks.iter().flat_map(|b| b.guides[..b.used].to_vec()).collect();
            seen.sort_unstable();
            assert_eq!(seen, (0..37).collect::<Vec<_>>());
            assert_eq!(blocks.iter().map(|b| b.locks).sum::<usize>(), locks);
            for block in &blocks {
                assert!(block.guides[block.used..].iter().all(|g| *g == block.guides[block.used - 1]));
            }
        }
    }

    #[test]
    fn the_guides_of_a_wisp_lie_side_by_side_unless_another_wisp_has_them() {
        let wisps = [wisp([5, 9, 2]), wisp([9, 10, 11]), wisp([1, 1, 1]), wisp([0, 3, 99]), wisp([4, 6, 8])];
        let blocks = pack(&guides(12), &wisps);
        let mut found: Vec<&[u32]> = blocks.iter().flat_map(|b| b.guides[..3 * b.locks].chunks(3)).collect();
        found.sort_unstable();
        assert_eq!(found, [[4, 6, 8], [5, 9, 2]]);
    }

    #[test]
    fn the_mean_is_that_of_the_own_lock() {
        let mut row = ZERO3;
        for k in 0..LANES {
            put(&mut row, k, Vec3::new(k as f32, (k * k) as f32, 1.0));
        }
        let mean = mean_of_lock(&row);
        for k in 0..LOCK * LOCKS {
            let first = k - k % LOCK;
            let want = (first..first + LOCK).map(|k| at(&row, k)).sum::<Vec3>() / 3.0;
            assert!((at(&mean, k) - want).length() < 1e-5, "lane {k}");
        }
    }
}
