// Optical depth before a point: that of the slabs before its own, and of its own the share of occupied slices before it.

fn depth_before(texel: u32, depth: f32) -> f32 {
    let record = record_of(texel);
    let far_word = map[record + 1u];
    let near = bitcast<f32>((map[record] >> SPARE) << 3u);
    let far = bitcast<f32>((far_word >> SPARE) << 3u);
    if (depth <= near) {
        return 0.0;
    }
    let mean = f32(1024u + ((map[record] & 31u) | ((far_word & 31u) << 5u)));
    let bits = record + 2u;
    let counts = bits + (texels.whole.x >> 5u);
    if (depth >= far) {
        return depth_of_weight(f32(total(counts)) * mean);
    }
    let place = slice_of(near, far, depth);
    let slice = u32(place.x);
    let slab = slice >> texels.whole.z;
    var before = 0u;
    for (var k = 0u; k < slab; k++) {
        before += (map[counts + (k >> 1u)] >> (16u * (k & 1u))) & 0xffffu;
    }
    let own = (map[counts + (slab >> 1u)] >> (16u * (slab & 1u))) & 0xffffu;
    // Bits of the slab, and those of them before the slice.
    let first = slab << texels.whole.z;
    let last = first + (1u << texels.whole.z) - 1u;
    var occupied = 0u;
    var passed = 0u;
    for (var word = first >> 5u; word <= (last >> 5u); word++) {
        var found = map[bits + word];
        if (last - first < 31u) {
            found &= ((1u << (last - first + 1u)) - 1u) << (first & 31u);
        }
        occupied += countOneBits(found);
        if (word < (slice >> 5u)) {
            passed += countOneBits(found);
        } else if (word == (slice >> 5u)) {
            passed += countOneBits(found & ((1u << (slice & 31u)) - 1u));
        }
    }
    let own_bit = f32((map[bits + (slice >> 5u)] >> (slice & 31u)) & 1u);
    let share = (f32(passed) + place.y * own_bit) / f32(max(occupied, 1u));
    return depth_of_weight((f32(before) + share * f32(own)) * mean);
}

fn total(counts: u32) -> u32 {
    var all = 0u;
    for (var k = 0u; k < texels.whole.y / 2u; k++) {
        let two = map[counts + k];
        all += (two & 0xffffu) + (two >> 16u);
    }
    return all;
}
