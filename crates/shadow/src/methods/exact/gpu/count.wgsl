// Counts the fragments of each texel. A texel has two words: start and end of its fragments in the list.

fn put(texel: u32, depth: f32, weight: u32) {
    atomicAdd(&map[texel * 2u + 1u], 1u);
}
