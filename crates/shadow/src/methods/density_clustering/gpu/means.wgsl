// Sums per cluster: weights, and weighted distances from the border before the cluster.

fn put(texel: u32, depth: f32, weight: u32) {
    let part = part_of(texel, depth);
    let place = place_of(texel, part);
    let sums = sums_of(texel, place.cluster);
    atomicAdd(&scratch[sums], weight);
    add_to_scratch(sums + 1u, vec2u(counted(part - place.border) * weight, 0u));
}
