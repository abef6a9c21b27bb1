// Writes each fragment into the list. Fragments beyond its capacity are dropped; then the list is enlarged and the frame is
// rendered again.

fn put(texel: u32, depth: f32, weight: u32) {
    let at = atomicAdd(&map[texel * 2u + 1u], 1u);
    if (at < list_room()) {
        list[LIST_HEAD + at] = vec2u(bitcast<u32>(depth), weight);
    }
}
