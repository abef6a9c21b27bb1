// Adds the depth of samples to the cells of bricks.

@group(0) @binding(3) var<storage, read> index: array<u32>;
@group(0) @binding(5) var<storage, read_write> list: array<atomic<u32>>;

fn add_sample(brick: u32, at: u32, depth: u32) {
    let number = index[brick];
    // A list that is too short is made again; until then nothing is written beyond its end.
    if (number == 0u || number > march.room) {
        return;
    }
    let cell = HEAD + (number - 1u) * BRICK_WORDS + at;
    let before = atomicAdd(&list[cell], depth);
    if (before + depth < before) {
        // Only the thread that sees the sum wrap around sets this bit: it outlasts all that are added before the next time.
        atomicOr(&list[cell], 0x80000000u);
    }
}
