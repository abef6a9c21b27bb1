//! Which images of a file are decoded, and at which size, before any of them is.

use std::collections::BinaryHeap;

/// Most pixels along a side of an image.
pub(super) const SIDE: u32 = 8192;
/// Most bytes of all decoded images.
pub(super) const TOTAL_BYTES: u64 = 512 << 20;
/// Most pixels of one image as the file stores it: 16,384 by 8,192.
const STORED_PIXELS: u64 = 1 << 27;
/// Most pixels of all images as the file stores them; a small file may hold many images of one colour.
const ALL_STORED_PIXELS: u64 = 1 << 29;
/// Most pixels along a side of an image as the file stores it.
pub(super) const STORED_SIDE: u32 = 1 << 15;

/// What becomes of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Decoded and halved so many times.
    Halved(u32),
    /// More pixels than are read.
    TooLarge,
    /// All images before it have as many pixels as are read together.
    TooMany,
}

/// Decides for images of known sizes.
pub(super) fn plan(sizes: &[[u32; 2]]) -> Vec<Verdict> {
    let mut stored = 0;
    let mut heap = BinaryHeap::new();
    let mut bytes = 0;
    let mut verdicts: Vec<Verdict> = sizes
        .iter()
        .enumerate()
        .map(|(index, &size)| {
            let pixels = u64::from(size[0]) * u64::from(size[1]);
            if pixels > STORED_PIXELS || size.iter().any(|&side| side > STORED_SIDE) {
                return Verdict::TooLarge;
            }
            if stored + pixels > ALL_STORED_PIXELS {
                return Verdict::TooMany;
            }
            stored += pixels;
            let halvings = (0..32).find(|&n| halved(size, n).iter().all(|&side| side <= SIDE)).unwrap_or(31);
            bytes += bytes_of(halved(size, halvings));
            heap.push((bytes_of(halved(size, halvings)), index));
            Verdict::Halved(halvings)
        })
        .collect();
    // The largest image loses pixels until all fit.
    while bytes > TOTAL_BYTES {
        let Some((own, index)) = heap.pop() else { break };
        let Verdict::Halved(halvings) = &mut verdicts[index] else { continue };
        let smaller = bytes_of(halved(sizes[index], *halvings + 1));
        // Images of one pixel each cannot become smaller.
        if smaller == own {
            break;
        }
        *halvings += 1;
        bytes = bytes - own + smaller;
        heap.push((smaller, index));
    }
    verdicts
}

/// A size after so many halvings: each rounds down, to 1 at least.
pub(super) fn halved(size: [u32; 2], times: u32) -> [u32; 2] {
    size.map(|side| side.checked_shr(times).unwrap_or(0).max(1))
}

fn bytes_of(size: [u32; 2]) -> u64 {
    4 * u64::from(size[0]) * u64::from(size[1])
}

#[cfg(test)]
mod tests {
    use super::{Verdict, plan};

    #[test]
    fn sizes_are_limited_before_anything_is_decoded() {
        use Verdict::{Halved, TooLarge, TooMany};
        assert_eq!(plan(&[[8192, 8192], [1, 1]]), [Halved(0), Halved(0)]);
        assert_eq!(plan(&[[8193, 16], [16_384, 4]]), [Halved(1), Halved(1)]);
        assert_eq!(plan(&[[60_000, 60_000], [60_000, 1]]), [TooLarge; 2]);
        // Two of 256 MB fill the memory; with a third, two of them are halved.
        assert_eq!(plan(&[[8192, 8192]; 2]), [Halved(0); 2]);
        let three = plan(&[[8192, 8192]; 3]);
        assert_eq!(three.iter().filter(|verdict| **verdict == Halved(1)).count(), 2, "{three:?}");
        let many = plan(&[[8192, 8192]; 9]);
        assert_eq!(many[8], TooMany);
        assert!(many[..8].iter().all(|verdict| matches!(verdict, Halved(1 | 0))), "{many:?}");
    }
}
