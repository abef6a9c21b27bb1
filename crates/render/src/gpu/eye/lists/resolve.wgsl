// Blends the fragments of a pixel from near to far. Twin of cpu/transparency/exact.rs.
//
// Builds a heap and removes the nearest fragment until the pixel is opaque.

fn key_at(at: u32) -> vec3u {
    return vec3u(list[at], list[at + 1u], list[at + 2u]);
}

// Whether `a` is nearer. Ties are broken by the other words, so that the result does not depend on the order of threads.
fn is_nearer(a: vec3u, b: vec3u) -> bool {
    if (a.x != b.x) {
        return a.x > b.x;
    }
    if (a.z != b.z) {
        return a.z > b.z;
    }
    return a.y > b.y;
}

// Sifts `item` down from index `start` of the heap that starts at word `first`.
fn sink(first: u32, count: u32, start: u32, item: vec3u) {
    var at = start;
    loop {
        var child = 2u * at + 1u;
        if (child >= count) {
            break;
        }
        var nearer = key_at(first + child * FRAGMENT_WORDS);
        if (child + 1u < count) {
            let other = key_at(first + (child + 1u) * FRAGMENT_WORDS);
            if (is_nearer(other, nearer)) {
                nearer = other;
                child += 1u;
            }
        }
        if (!is_nearer(nearer, item)) {
            break;
        }
        put_at(first + at * FRAGMENT_WORDS, nearer);
        at = child;
    }
    put_at(first + at * FRAGMENT_WORDS, item);
}

fn put_at(at: u32, item: vec3u) {
    list[at] = item.x;
    list[at + 1u] = item.y;
    list[at + 2u] = item.z;
}

fn pixel_pass(pixel: u32) {
    let record = pixel * RECORD_WORDS;
    let begin = atomicLoad(&map[record]);
    let there = min(atomicLoad(&map[record + 1u]), atomicLoad(&map[record + 2u]));
    var count = min(there, eye.room - min(begin, eye.room));
    let first = begin * FRAGMENT_WORDS;
    for (var k = count / 2u; k > 0u; k--) {
        sink(first, count, k - 1u, key_at(first + (k - 1u) * FRAGMENT_WORDS));
    }
    var color = vec3f(0.0);
    var through = 1.0;
    while (count > 0u && through > 1e-4) {
        let nearest = key_at(first);
        let rg = unpack2x16float(nearest.y);
        let ba = unpack2x16float(nearest.z);
        let share = ba.y * through;
        color += share * vec3f(rg, ba.x);
        through -= share;
        count -= 1u;
        if (count > 0u) {
            sink(first, count, 0u, key_at(first + count * FRAGMENT_WORDS));
        }
    }
    write_layer(pixel, color, max(through, 0.0));
}
