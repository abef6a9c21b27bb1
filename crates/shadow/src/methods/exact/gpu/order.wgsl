// The order of the fragments of a texel: by depth, then by weight, so that it is unique.

// Longer lists are sorted by a workgroup.
const LONG: u32 = 1024u;

fn lies_before(a: vec2u, b: vec2u) -> bool {
    // Depths are not negative, so their bits have the same order.
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

// A saturating sum of weights. It saturates after at least three million fragments.
fn sum_of(a: u32, b: u32) -> u32 {
    return select(a + b, 0xffffffffu, a + b < a);
}

// The index of the first fragment of a texel in the list, and the number of its fragments.
fn list_of(texel: u32) -> vec2u {
    let end = min(atomicLoad(&map[texel * 2u + 1u]), list_room());
    let start = min(atomicLoad(&map[texel * 2u]), end);
    return vec2u(LIST_HEAD + start, end - start);
}
