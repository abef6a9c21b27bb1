//! What the methods share that hold all hair of a texel as one function between the ends of a depth range.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

/// Cells of a record before the function: both ends of the range, and the optical depth of all hair.
pub(crate) const HEADER: usize = 3;

/// The part of the range before a depth, 0 to 1.
#[inline(always)]
pub(crate) fn part_of(near: f32, far: f32, depth: f32) -> f32 {
    let part = (depth - near) * (1.0 / (far - near));
    // NaN becomes 0.
    let part = if part > 0.0 { part } else { 0.0 };
    if part < 1.0 { part } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_lie_within_the_range_and_all_hair_at_one_depth_is_at_its_start() {
        for (depth, part) in [(0.1, 0.0), (0.2, 0.0), (0.3, 0.25), (0.6, 1.0), (2.0, 1.0), (f32::NAN, 0.0)] {
            assert!((part_of(0.2, 0.6, depth) - part).abs() < 1e-6, "{depth}");
        }
        assert_eq!(part_of(0.5, 0.5, 0.5), 0.0);
    }
}
