// Puts each fragment into the list. What there is no room for is left out; the list is then made larger and all drawn anew.

fn put(texel: u32, depth: f32, weight: u32) {
    let at = atomicAdd(&map[texel * 2u + 1u], 1u);
    if (at < list_room()) {
        list[LIST_HEAD + at] = vec2u(bitcast<u32>(depth), weight);
    }
}
