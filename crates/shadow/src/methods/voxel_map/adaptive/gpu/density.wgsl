// Adds the weight of each fragment to its slice.

fn put(texel: u32, depth: f32, weight: u32) {
    let record = record_of(texel);
    let shares = vec2u(atomicLoad(&map[record + 1u]), atomicLoad(&map[record + 2u]));
    let slice = min(u32(slices_before(atomicLoad(&map[record]), shares, depth)), texels.parts - 1u);
    atomicAdd(&map[record + HEADER + slice], weight);
}
