// The head of a list of fragments: in two words, how many all texels have. See list.rs.

@group(0) @binding(5) var<storage, read_write> list: array<atomic<u32>>;

// Counts the fragments of many texels and says where in the list theirs begin.
fn take(count: u32) -> u32 {
    // The second word takes what the first one would lose where it wraps around.
    atomicAdd(&list[1], count >> 16u);
    return atomicAdd(&list[0], count);
}
