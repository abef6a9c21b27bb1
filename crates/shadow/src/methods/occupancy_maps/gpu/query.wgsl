// Optical depth before a point: that of the slabs before its own, and of its own the share of occupied slices before it.

fn depth_before(texel: u32, depth: f32) -> f32 {
    let record = record_of(texel);
    let near_word = map[record];
    let far_word = map[record + 1u];
    let near = bitcast<f32>((near_word >> SPARE) << 3u);
    // The mean of a texel with hair is not 0.
    if (depth <= near || (near_word | far_word) == 0u) {
        return 0.0;
    }
    let far = bitcast<f32>((far_word >> SPARE) << 3u);
    let mean = f32(1023u + ((near_word & 31u) | ((far_word & 31u) << 5u)));
    let bits = record + 2u;
    let counts = bits + (texels.whole.x >> 5u);
    let place = slice_of(near, far, depth);
    let slice = u32(place.x);
    // Behind all hair every slab lies before.
    let slab = select(slice >> texels.whole.z, texels.whole.y, depth >= far);
    // Counts, two a word: those of the slabs before, and of the slab itself.
    var before = 0u;
    var own = 0u;
    for (var k = 0u; k < texels.whole.y / 2u && 2u * k <= slab; k++) {
        let two = map[counts + k];
        let low = two & 0xffffu;
        let high = two >> 16u;
        before += select(0u, low, 2u * k < slab) + select(0u, high, 2u * k + 1u < slab);
        own += select(0u, low, 2u * k == slab) + select(0u, high, 2u * k + 1u == slab);
    }
    if (depth >= far) {
        return depth_of_weight(f32(before) * mean);
    }
    // Fragments of one depth lie between two neighbouring numbers here. A point at this depth comes before them.
    if ((far_word >> SPARE) - (near_word >> SPARE) <= 1u) {
        return 0.0;
    }
    // Bits of the slab, and those of them before the slice.
    var occupied = 0u;
    var passed = 0u;
    let slice_bits = map[bits + (slice >> 5u)];
    let before_slice = slice_bits & ((1u << (slice & 31u)) - 1u);
    if (texels.whole.z <= 5u) {
        // A slab lies within one word.
        let first = (slab << texels.whole.z) & 31u;
        let mask = (0xffffffffu >> (32u - (1u << texels.whole.z))) << first;
        occupied = countOneBits(slice_bits & mask);
        passed = countOneBits(before_slice & mask);
    } else {
        let first = slab << (texels.whole.z - 5u);
        passed = countOneBits(before_slice);
        for (var k = 0u; k < (1u << (texels.whole.z - 5u)); k++) {
            let ones = countOneBits(map[bits + first + k]);
            occupied += ones;
            passed += select(0u, ones, first + k < (slice >> 5u));
        }
    }
    let own_bit = f32((slice_bits >> (slice & 31u)) & 1u);
    let share = (f32(passed) + place.y * own_bit) / f32(max(occupied, 1u));
    return depth_of_weight((f32(before) + share * f32(own)) * mean);
}
