// The record of a pixel: for each of its samples the nearest depth, and its colour with a shared exponent. Twin of
// cpu/transparency/opaque.rs.

const RECORD_WORDS: u32 = 8u;

// Nine bits per channel, and five for the exponent in the highest bits: at equal depth the brightest wins, so that the picture does
// not depend on the order of threads.
fn pack_color(color: vec3f) -> u32 {
    let c = clamp(color, vec3f(0.0), vec3f(65408.0));
    let most = max(c.r, max(c.g, c.b));
    let exponent = clamp(i32(floor(log2(max(most, 1e-6)))) + 16, 0, 31);
    let scale = exp2(f32(24 - exponent));
    let parts = min(vec3u(c * scale + 0.5), vec3u(511u));
    return (u32(exponent) << 27u) | (parts.r << 18u) | (parts.g << 9u) | parts.b;
}

fn unpack_color(packed: u32) -> vec3f {
    let scale = exp2(f32(i32(packed >> 27u) - 24));
    return vec3f(f32((packed >> 18u) & 511u), f32((packed >> 9u) & 511u), f32(packed & 511u)) * scale;
}
