// Optical depth before a point: that of the slabs before its own, and the fraction of its own slab given by the share of
// occupied slices before the point.
//
// Branches depend on pipeline constants only: every point performs every read.

// For two slabs whose counts are in one word: fragments before slab `slab`, and in it.
fn around(counts: u32, two: u32, slab: u32) -> vec2u {
    let words = map[counts + two];
    let low = words & 0xffffu;
    let high = words >> 16u;
    let first = 2u * two;
    return vec2u(
        select(0u, low, first < slab) + select(0u, high, first + 1u < slab),
        select(0u, low, first == slab) + select(0u, high, first + 1u == slab),
    );
}

// The number of bits that are set in a word of a slab, and of those before the slice.
fn occupied_in(bits: u32, first: u32, k: u32, slice: u32) -> vec2u {
    let ones = countOneBits(map[bits + first + k]);
    return vec2u(ones, select(0u, ones, first + k < (slice >> 5u)));
}

fn depth_before(texel: u32, depth: f32) -> f32 {
    let record = record_of(texel);
    let near_word = map[record];
    let far_word = map[record + 1u];
    let near = bitcast<f32>(near_word);
    let far = bitcast<f32>(far_word);
    // 0 without hair.
    let mean = bitcast<f32>(map[record + 2u]);
    let bits = record + HEADER;
    let counts = counts_of(record);
    let place = slice_of(near, far, depth);
    let slice = u32(place.x);
    // Behind all hair, every slab counts.
    let slab = select(slice >> SLAB_SHIFT, SLABS, depth >= far);
    var sums = around(counts, 0u, slab) + around(counts, 1u, slab);
    if (SLABS > 4u) {
        sums += around(counts, 2u, slab) + around(counts, 3u, slab);
    }
    if (SLABS > 8u) {
        sums += around(counts, 4u, slab) + around(counts, 5u, slab);
        sums += around(counts, 6u, slab) + around(counts, 7u, slab);
    }
    // The number of bits of the slab, and of those before the slice.
    let slice_bits = map[bits + (slice >> 5u)];
    let before_slice = slice_bits & ((1u << (slice & 31u)) - 1u);
    var occupied: vec2u;
    if (SLAB_SHIFT <= 5u) {
        // A slab lies within one word.
        let first = (slice >> SLAB_SHIFT << SLAB_SHIFT) & 31u;
        let mask = (0xffffffffu >> (32u - (1u << min(SLAB_SHIFT, 5u)))) << first;
        occupied = vec2u(countOneBits(slice_bits & mask), countOneBits(before_slice & mask));
    } else {
        let first = slice >> SLAB_SHIFT << (max(SLAB_SHIFT, 5u) - 5u);
        occupied = occupied_in(bits, first, 0u, slice) + occupied_in(bits, first, 1u, slice);
        if (SLAB_SHIFT > 6u) {
            occupied += occupied_in(bits, first, 2u, slice) + occupied_in(bits, first, 3u, slice);
        }
        occupied.y += countOneBits(before_slice);
    }
    let own_bit = f32((slice_bits >> (slice & 31u)) & 1u);
    let share = (f32(occupied.y) + place.y * own_bit) / f32(max(occupied.x, 1u));
    // Fragments of one depth lie between two neighbouring numbers here. A point at this depth counts as before them.
    let one_depth = far_word - near_word <= 8u;
    let within = select(f32(sums.x) + share * f32(sums.y), 0.0, one_depth);
    let fragments = select(within, f32(sums.x), depth >= far);
    return select(depth_of_weight(fragments * mean), 0.0, depth <= near);
}
