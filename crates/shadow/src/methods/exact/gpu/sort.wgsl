// Sorts the fragments of texels with few; weights become running sums.

// Longer lists use heapsort.
const SHORT: u32 = 24u;

// Sifts the fragment at `top` down in the heap of `count` fragments that starts at `first`.
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
    let own_list = list_of(texel);
    let first = own_list.x;
    let count = own_list.y;
    if (count > LONG) {
        return;
    }
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
        sum = sum_of(sum, list[first + i].y);
        list[first + i].y = sum;
    }
}
