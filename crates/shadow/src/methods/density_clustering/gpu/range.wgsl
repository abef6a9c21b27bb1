// The depth range of each texel.

fn put(texel: u32, depth: f32, weight: u32) {
    // Depths are not negative, so their bits have the same order.
    let bits = bitcast<u32>(depth);
    let at = scratch_of(texel);
    if (atomicLoad(&scratch[at]) < ~bits) {
        atomicMax(&scratch[at], ~bits);
    }
    if (atomicLoad(&scratch[at + 1u]) < bits) {
        atomicMax(&scratch[at + 1u], bits);
    }
}
