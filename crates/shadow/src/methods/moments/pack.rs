//! Moments in 16 bits. Twin of pack.wgsl.
//!
//! Moments with the same depths are nearly alike. A linear transform makes use of the whole range of 16 bits (Münstermann and others
//! 2018, supplement).
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

/// √3 / 2.
const HALF_ROOT: f32 = 0.866_025_4;
/// 2 √3 / 9.
const NINTHS: f32 = 0.384_900_18;
/// The largest integer of 16 bits.
const MOST: f32 = 65_535.0;

/// The integer of 16 bits of a number from 0 to 1.
#[inline(always)]
fn to_bits(part: f32) -> u32 {
    (part.clamp(0.0, 1.0) * MOST + 0.5) as u32
}

/// The means of z, z², z³ and z⁴ in two words.
pub(super) fn pack(b: [f32; 4]) -> [u32; 2] {
    let odd = [1.5 * b[0] - 2.0 * b[2] + 0.5, HALF_ROOT * b[0] - NINTHS * b[2] + 0.5];
    let even = [4.0 * (b[1] - b[3]), 0.5 * (b[1] + b[3])];
    [to_bits(odd[0]) | to_bits(odd[1]) << 16, to_bits(even[0]) | to_bits(even[1]) << 16]
}

/// The means in two words.
#[inline(always)]
pub(super) fn unpack(words: [u32; 2]) -> [f32; 4] {
    let part = |bits: u32| bits as f32 * (1.0 / MOST);
    let odd = [part(words[0] & 0xffff) - 0.5, part(words[0] >> 16) - 0.5];
    let even = [part(words[1] & 0xffff), part(words[1] >> 16)];
    [
        odd[0] * (-1.0 / 3.0) + odd[1] * (2.0 * HALF_ROOT),
        0.125 * even[0] + even[1],
        odd[0] * -0.75 + odd[1] * (1.5 * HALF_ROOT),
        even[1] - 0.125 * even[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_lose_no_more_than_a_few_steps() {
        for i in -100_i16..=100 {
            for j in -10_i16..=10 {
                let (a, b) = (f32::from(i) * 0.01, f32::from(j) * 0.1);
                let moments = [1, 2, 3, 4].map(|k| 0.3 * a.powi(k) + 0.7 * b.powi(k));
                let found = unpack(pack(moments));
                for (found, moment) in found.iter().zip(moments) {
                    assert!((found - moment).abs() < 2e-5, "{moments:?}: {found:?}");
                }
            }
        }
    }
}
