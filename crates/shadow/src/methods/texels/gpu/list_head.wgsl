// The header of a list of fragments: their number, in two words. See list.rs.

@group(0) @binding(5) var<storage, read_write> list: array<atomic<u32>>;

// Adds to the number of fragments. Returns where in the list the new ones start.
fn take(count: u32) -> u32 {
    // The second word keeps the high bits that the first one loses when it wraps around.
    atomicAdd(&list[1], count >> 16u);
    return atomicAdd(&list[0], count);
}
