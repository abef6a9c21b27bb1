// Moments in 16 bits. Twin of pack.rs.

// √3 / 2.
const HALF_ROOT: f32 = 0.8660254;
// 2 √3 / 9.
const NINTHS: f32 = 0.38490018;
// The largest integer of 16 bits.
const MOST: f32 = 65535.0;

fn to_bits(part: f32) -> u32 {
    return u32(clamp(part, 0.0, 1.0) * MOST + 0.5);
}

fn pack_moments(b: vec4f) -> vec2u {
    let odd = vec2f(1.5 * b.x - 2.0 * b.z + 0.5, HALF_ROOT * b.x - NINTHS * b.z + 0.5);
    let even = vec2f(4.0 * (b.y - b.w), 0.5 * (b.y + b.w));
    return vec2u(to_bits(odd.x) | (to_bits(odd.y) << 16u), to_bits(even.x) | (to_bits(even.y) << 16u));
}

fn unpack_moments(words: vec2u) -> vec4f {
    let odd = vec2f(vec2u(words.x & 0xffffu, words.x >> 16u)) * (1.0 / MOST) - 0.5;
    let even = vec2f(vec2u(words.y & 0xffffu, words.y >> 16u)) * (1.0 / MOST);
    return vec4f(
        odd.x * (-1.0 / 3.0) + odd.y * (2.0 * HALF_ROOT),
        0.125 * even.x + even.y,
        odd.x * -0.75 + odd.y * (1.5 * HALF_ROOT),
        even.y - 0.125 * even.x,
    );
}
