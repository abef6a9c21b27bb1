// Sums per cluster: weights, and weighted squares of distances from the centre.

fn put(texel: u32, depth: f32, weight: u32) {
    let part = part_of(texel, depth);
    let cluster = place_of(texel, part).cluster;
    let sums = sums_of(texel, cluster);
    let distance = counted(abs(part - centre(texel, cluster)));
    atomicAdd(&scratch[sums], weight);
    add_to_scratch(sums + 1u, weighted_square(distance, weight));
}
