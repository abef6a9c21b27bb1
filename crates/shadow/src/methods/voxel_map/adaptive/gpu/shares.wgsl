// Weighs the hair of each bin.

fn put(texel: u32, depth: f32, weight: u32) {
    let bin = min(u32(bins_before(rounded_range(texel), depth)), BINS - 1u);
    atomicAdd(&scratch[weights_of(texel) + bin], weight);
}
