// Marks the bricks that hold hair.

@group(0) @binding(3) var<storage, read_write> index: array<atomic<u32>>;

fn add_sample(brick: u32, at: u32, depth: u32) {
    // Most samples find their brick marked.
    if (atomicLoad(&index[brick]) == 0u) {
        atomicStore(&index[brick], 1u);
    }
}
