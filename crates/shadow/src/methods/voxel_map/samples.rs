//! The samples of a segment that are added to cells.
//!
//! The fast map and the reference share these functions, so that a sample at the border of two cells falls on the same side
//! in both.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::simd::whole_part;

/// The number of samples of a segment of `length` cells: neighbouring samples are at most half a cell apart.
#[inline(always)]
pub(super) fn sample_count(length: f32) -> u32 {
    // `⌊2·length⌋ + 1`: SSE2 has no instruction for the ceiling.
    // At most 2^26 + 1; a check for overflow would be a branch in loops of vectors.
    (whole_part(2.0 * length) as u32).wrapping_add(1)
}

/// The position of sample `index` along its segment, 0 to 1. `inverse_count` is 1 over the number of samples.
#[inline(always)]
pub(super) fn sample_at(index: u32, inverse_count: f32) -> f32 {
    (index as i32 as f32 + 0.5) * inverse_count
}
