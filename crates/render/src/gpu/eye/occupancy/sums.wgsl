// Sums the optical depths of slabs, from the nearest on.

fn pixel_pass(pixel: u32) {
    let record = pixel * RECORD_WORDS;
    if (atomicLoad(&map[record]) == 0u) {
        return;
    }
    var sum = 0u;
    for (var k = 0u; k < 8u; k++) {
        // Each is below 2^31, and the sum is clamped to stay there.
        sum = min(sum + atomicLoad(&map[record + SLABS_AT + k]), 0x40000000u);
        atomicStore(&map[record + SLABS_AT + k], sum);
    }
}
