// The depth range of each texel and the sum of its weights in two words, in `RANGE_WORDS` words of scratch memory per texel.
//
// The bits of the nearest depth are inverted, so that 0 means no hair.

fn put(texel: u32, depth: f32, weight: u32) {
    // Depths are not negative, so their bits have the same order.
    let bits = bitcast<u32>(depth);
    let at = texel * 4u;
    if (atomicLoad(&scratch[at]) < ~bits) {
        atomicMax(&scratch[at], ~bits);
    }
    if (atomicLoad(&scratch[at + 1u]) < bits) {
        atomicMax(&scratch[at + 1u], bits);
    }
    let before = atomicAdd(&scratch[at + 2u], weight);
    if (before + weight < before) {
        atomicAdd(&scratch[at + 3u], 1u);
    }
}
