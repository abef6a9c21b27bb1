//! How a segment is cut into the samples that are put into cells.
//!
//! The quick map and the reference share these two lines, so that a sample at a cell's border falls on the
//! same side in both.
// Compiled within the versions of `simd`.
#![allow(clippy::inline_always)]

use lovelock_groom::simd::whole_part;

/// Number of samples of a segment of `length` cells: no two of them more than half a cell apart.
#[inline(always)]
pub(super) fn sample_count(length: f32) -> u32 {
    // `⌈2·length⌉`, but at least 1, and one more where that is a whole number: SSE2 has no ceiling.
    whole_part(2.0 * length) as u32 + 1
}

/// Where along its segment sample `index` lies, 0 to 1; `inverse_count` is 1 over the number of samples.
#[inline(always)]
pub(super) fn sample_at(index: u32, inverse_count: f32) -> f32 {
    (index as i32 as f32 + 0.5) * inverse_count
}
