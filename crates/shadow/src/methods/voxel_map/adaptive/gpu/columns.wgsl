// A record consists of words: the depths of the nearest and of the farthest hair, 16 bits each; the shares of hair before each of the
// eight bins between them, 8 bits each; and the weight before the end of each slice. Twin of columns.rs.
// `texels.parts`: slices.

// Words before the slices.
const HEADER: u32 = 3u;
const BINS: u32 = 8u;
// Steps of the ends of a column, and of the share of hair before a bin.
const DEPTHS: f32 = 65535.0;
const SHARES: f32 = 256.0;

fn record_of(texel: u32) -> u32 {
    return texel * (HEADER + texels.parts);
}

// A depth in bins: 0 before the hair, 8 behind it.
fn bins_before(range: u32, depth: f32) -> f32 {
    let near = f32(range & 0xffffu);
    let part = (depth * DEPTHS - near) / (f32(range >> 16u) - near);
    // Without hair this is NaN or infinite.
    return min(select(0.0, part, part > 0.0), 1.0) * f32(BINS);
}

// The share of hair before bin `bin`.
fn share_before(shares: vec2u, bin: u32) -> f32 {
    let word = select(shares.x, shares.y, bin >= 4u);
    return select(f32((word >> (8u * (bin & 3u))) & 0xffu), SHARES, bin == BINS);
}

// A depth in slices.
fn slices_before(range: u32, shares: vec2u, depth: f32) -> f32 {
    let at = bins_before(range, depth);
    let bin = min(u32(at), BINS - 1u);
    let before = share_before(shares, bin);
    let behind = share_before(shares, bin + 1u);
    return (before + (behind - before) * (at - f32(bin))) * (f32(texels.parts) / SHARES);
}
