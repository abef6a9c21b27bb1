// Occupied slices, and the optical depth of slabs.

fn take(pixel: u32, fragment: Fragment) {
    let record = pixel * RECORD_WORDS;
    // The farthest distance belongs to the last slice.
    let slice = min(u32(slice_of(record, fragment.depth)), u32(SLICES) - 1u);
    let word = record + BITS_AT + (slice >> 5u);
    let bit = 1u << (slice & 31u);
    if ((atomicLoad(&map[word]) & bit) == 0u) {
        atomicOr(&map[word], bit);
    }
    let slab = record + SLABS_AT + (slice >> 4u);
    // Far from overflow, and darker than anything visible.
    if (atomicLoad(&map[slab]) < 0x40000000u) {
        atomicAdd(&map[slab], u32(optical_depth(opacity_of(fragment)) * DEPTH_ONE + 0.5));
    }
}
