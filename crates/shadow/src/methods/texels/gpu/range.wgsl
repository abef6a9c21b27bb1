// The depth range of each texel and the sum of its weights, in `RANGE` words of the scratch memory a texel.
//
// The nearest depth is kept turned round, so that 0 stands for none at all.

fn put(texel: u32, depth: f32, weight: u32) {
    // Depths are not negative: their bits are ordered as they are.
    let bits = bitcast<u32>(depth);
    let at = texel * 3u;
    if (atomicLoad(&scratch[at]) < ~bits) {
        atomicMax(&scratch[at], ~bits);
    }
    if (atomicLoad(&scratch[at + 1u]) < bits) {
        atomicMax(&scratch[at + 1u], bits);
    }
    atomicAdd(&scratch[at + 2u], weight);
}
