//! The whole part of a float, in a form that vectorises.
//!
//! Unsafe because the vectorising conversion of a float to an integer is undefined out of range.
// Compiled within the versions of `simd`.
#![allow(unsafe_code, clippy::inline_always)]

/// The whole part of `c` clamped to 0..=2^26; 0 for NaN.
///
/// `as` would compile to one or two branches per number, because it saturates at the integers' limits.
#[inline(always)]
pub fn whole_part(c: f32) -> i32 {
    const MAX: f32 = (1 << 26) as f32;
    let c = if c > 0.0 { c } else { 0.0 };
    let c = if c < MAX { c } else { MAX };
    // SAFETY: `c` is a number between 0 and 2^26: the comparison above turns NaN into 0.
    unsafe { c.to_int_unchecked() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_parts() {
        let cases = [(0.0, 0), (0.999_999_94, 0), (1.0, 1), (511.999, 511), (8_388_607.0, 8_388_607)];
        let beyond =
            [(-1.0, 0), (f32::NAN, 0), (f32::NEG_INFINITY, 0), (f32::INFINITY, 1 << 26), (1e9, 1 << 26)];
        for (c, whole) in cases.into_iter().chain(beyond) {
            assert_eq!(whole_part(c), whole, "{c}");
        }
    }
}
