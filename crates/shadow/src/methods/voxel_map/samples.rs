//! How a segment is cut into the samples that are put into cells.

/// Longest run of samples that one segment may take. Beyond it a segment is longer than any window.
pub const MOST_SAMPLES: u32 = 4096;

/// Number of samples of a segment of `length` cells: no two of them more than half a cell apart.
///
/// 0 for a length that is no number.
#[inline(always)]
pub fn sample_count(length: f32) -> u32 {
    // Saturating, and 0 for NaN. `as` truncates: one more than the whole part is the ceiling, or one above it
    // where the length is a whole number of half cells, which does no harm.
    (2.0 * length) as u32 + 1
}
