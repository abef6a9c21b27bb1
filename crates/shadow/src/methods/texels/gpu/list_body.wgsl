// The fragments of a list: bits of the depth, and a value of the pass. The first two items are the header.

@group(0) @binding(5) var<storage, read_write> list: array<vec2u>;

const LIST_HEAD: u32 = 2u;

// The capacity, fragments.
fn list_room() -> u32 {
    return arrayLength(&list) - LIST_HEAD;
}
