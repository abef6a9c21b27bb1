// The colour of the nearest strand.

fn take(pixel: u32, fragment: Fragment) {
    let samples = covered_samples(fragment);
    let bits = bitcast<u32>(fragment.depth);
    for (var k = 0u; k < 4u; k++) {
        let at = pixel * RECORD_WORDS + k;
        // A tolerance of a few ULP: the two passes are different programs, which may round differently.
        if (((samples >> k) & 1u) != 0u && atomicLoad(&map[at]) <= bits + 4u) {
            atomicMax(&map[at + 4u], pack_color(fragment.color));
        }
    }
}
