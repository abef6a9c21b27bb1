// The order of the fragments of a texel: by depth, then by weight, so that nothing is left to chance.

// Longer lists are sorted by a workgroup.
const LONG: u32 = 1024u;

fn lies_before(a: vec2u, b: vec2u) -> bool {
    // Depths are not negative: their bits are ordered as they are.
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

// A sum of weights. It stops at the largest number, after three million fragments at least.
fn sum_of(a: u32, b: u32) -> u32 {
    return select(a + b, 0xffffffffu, a + b < a);
}

// Where the fragments of a texel begin in the list, and how many there are.
fn list_of(texel: u32) -> vec2u {
    let end = min(atomicLoad(&map[texel * 2u + 1u]), list_room());
    let start = min(atomicLoad(&map[texel * 2u]), end);
    return vec2u(LIST_HEAD + start, end - start);
}
