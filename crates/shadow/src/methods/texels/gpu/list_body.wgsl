// The fragments of a list: bits of the depth, and what the pass says. The first two are the head.

@group(0) @binding(5) var<storage, read_write> list: array<vec2u>;

const LIST_HEAD: u32 = 2u;

// How many fragments there is room for.
fn list_room() -> u32 {
    return arrayLength(&list) - LIST_HEAD;
}
