//! Lists of the items that touch each tile of the picture.

use lovelock_base::memory::list_bytes;
use rayon::prelude::*;

/// The most pieces that items are divided into: more would make the counts larger than the lists.
const MAX_PIECES: usize = 64;
/// Items per task at least.
const PIECE: usize = 2048;

/// Tiles from `x0` to `x1` and from `y0` to `y1`, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TileRange {
    pub x0: u16,
    pub x1: u16,
    pub y0: u16,
    pub y1: u16,
}

/// For each tile, the items that touch it in the order of their index: the same for any number of threads.
#[derive(Clone, Debug, Default)]
pub(super) struct Bins {
    /// For each piece and tile, the position of its next item.
    next: Vec<u32>,
    starts: Vec<u32>,
    items: Vec<u32>,
    shares: Vec<Vec<(u32, u32)>>,
}

impl Bins {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        [&self.next, &self.starts, &self.items].into_iter().map(list_bytes).sum::<u64>()
            + self.shares.iter().map(list_bytes).sum::<u64>()
    }

    /// Sorts `count` items into a grid of `columns` by `rows` tiles.
    pub fn fill(
        &mut self,
        count: usize,
        columns: usize,
        rows: usize,
        range_of: impl Fn(usize) -> Option<TileRange> + Sync,
    ) {
        let tiles = columns * rows;
        let pieces = count.div_ceil(PIECE).clamp(1, MAX_PIECES);
        let piece_of = |piece: usize| count * piece / pieces..count * (piece + 1) / pieces;
        self.next.clear();
        self.next.resize(pieces * tiles, 0);
        self.shares.resize_with(pieces, Vec::new);
        self.next.par_chunks_mut(tiles.max(1)).zip(&mut self.shares).enumerate().for_each(
            |(piece, (counts, share))| {
                share.clear();
                for i in piece_of(piece) {
                    let Some(range) = range_of(i) else { continue };
                    for y in usize::from(range.y0)..=usize::from(range.y1) {
                        for x in usize::from(range.x0)..=usize::from(range.x1) {
                            let tile = y * columns + x;
                            counts[tile] += 1;
                            share.push((tile as u32, i as u32));
                        }
                    }
                }
            },
        );
        self.starts.clear();
        self.starts.resize(tiles + 1, 0);
        let mut sum = 0;
        for tile in 0..tiles {
            self.starts[tile] = sum;
            for piece in 0..pieces {
                let count = &mut self.next[piece * tiles + tile];
                let here = *count;
                *count = sum;
                sum += here;
            }
        }
        self.starts[tiles] = sum;
        self.items.resize(sum as usize, 0);
        // One thread: one store per item, limited by memory bandwidth.
        for (piece, share) in self.shares.iter().enumerate() {
            let next = &mut self.next[piece * tiles..(piece + 1) * tiles];
            for &(tile, item) in share {
                let slot = &mut next[tile as usize];
                self.items[*slot as usize] = item;
                *slot += 1;
            }
        }
    }

    /// The items that touch `tile`, in the order of their index.
    pub fn of(&self, tile: usize) -> &[u32] {
        &self.items[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_lists_what_touches_it_in_order() {
        let range_of = |i: usize| {
            let (x, y) = ((i * 7 % 5) as u16, (i * 3 % 4) as u16);
            (!i.is_multiple_of(11)).then_some(TileRange { x0: x, x1: (x + 1).min(4), y0: y, y1: y })
        };
        let mut bins = Bins::default();
        for count in [0, 1, 100, 10_000] {
            bins.fill(count, 5, 4, range_of);
            for tile in 0..20 {
                let expected: Vec<u32> = (0..count)
                    .filter(|&i| {
                        range_of(i).is_some_and(|r| {
                            let (x, y) = ((tile % 5) as u16, (tile / 5) as u16);
                            (r.x0..=r.x1).contains(&x) && (r.y0..=r.y1).contains(&y)
                        })
                    })
                    .map(|i| i as u32)
                    .collect();
                assert_eq!(bins.of(tile), expected, "{count} things, tile {tile}");
            }
        }
    }
}
