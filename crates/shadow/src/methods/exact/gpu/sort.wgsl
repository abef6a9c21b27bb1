// Sorts the fragments of a texel by depth, then by weight, so that no order is left to chance; weights become running sums.

// Longer lists are sorted in a heap.
const SHORT: u32 = 24u;

fn lies_before(a: vec2u, b: vec2u) -> bool {
    // Depths are not negative: their bits are ordered as they are.
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

// Lets the fragment at `top` of the heap that begins at `first` and has `count` fragments sink to its place.
fn sink(first: u32, count: u32, top: u32) {
    let own = list[first + top];
    var hole = top;
    for (var below = 2u * top + 1u; below < count; below = 2u * below + 1u) {
        if (below + 1u < count && lies_before(list[first + below], list[first + below + 1u])) {
            below++;
        }
        if (!lies_before(own, list[first + below])) {
            break;
        }
        list[first + hole] = list[first + below];
        hole = below;
    }
    list[first + hole] = own;
}

fn texel_pass(texel: u32) {
    let end = min(atomicLoad(&map[texel * 2u + 1u]), list_room());
    let start = min(atomicLoad(&map[texel * 2u]), end);
    let first = LIST_HEAD + start;
    let count = end - start;
    if (count <= SHORT) {
        for (var i = 1u; i < count; i++) {
            let own = list[first + i];
            var at = i;
            while (at > 0u && lies_before(own, list[first + at - 1u])) {
                list[first + at] = list[first + at - 1u];
                at--;
            }
            list[first + at] = own;
        }
    } else {
        for (var top = count / 2u; top > 0u; top--) {
            sink(first, count, top - 1u);
        }
        for (var last = count - 1u; last > 0u; last--) {
            let farthest = list[first];
            list[first] = list[first + last];
            list[first + last] = farthest;
            sink(first, last, 0u);
        }
    }
    var sum = 0u;
    for (var i = 0u; i < count; i++) {
        let more = sum + list[first + i].y;
        // Stops at the largest number: after three million fragments at least.
        sum = select(more, 0xffffffffu, more < sum);
        list[first + i].y = sum;
    }
}
