// Sums per cluster: weights, weighted distances from the border before the cluster, and weighted squares of them.

fn put(texel: u32, depth: f32, weight: u32) {
    let part = part_of(texel, depth);
    let place = place_of(texel, part);
    let sums = sums_of(texel, place.cluster);
    let distance = counted(part - place.border);
    atomicAdd(&scratch[sums], weight);
    add_to_scratch(sums + 1u, vec2u(distance * weight, 0u));
    add_to_map(bin_of(texel, place.cluster) + 1u, weighted_square(distance, weight));
}
