// Bits and counts in one pass.

fn put(texel: u32, depth: f32, weight: u32) {
    let slice = u32(slice_of(near_of(texel), far_of(texel), depth).x);
    let record = record_of(texel);
    let word = record + HEADER + (slice >> 5u);
    let bit = 1u << (slice & 31u);
    if ((atomicLoad(&map[word]) & bit) == 0u) {
        atomicOr(&map[word], bit);
    }
    let slab = slice >> SLAB_SHIFT;
    let counts = counts_of(record) + (slab >> 1u);
    let shift = 16u * (slab & 1u);
    var before = atomicLoad(&map[counts]);
    if (((before >> shift) & 0xffffu) < 0x8000u) {
        // There are never enough threads in flight to overflow the remainder.
        atomicAdd(&map[counts], 1u << shift);
        return;
    }
    // Counts saturate.
    while (((before >> shift) & 0xffffu) != 0xffffu) {
        let tried = atomicCompareExchangeWeak(&map[counts], before, before + (1u << shift));
        if (tried.exchanged) {
            break;
        }
        before = tried.old_value;
    }
}
