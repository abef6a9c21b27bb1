// Counts the fragments of each pixel.

fn take(pixel: u32, fragment: Fragment) {
    atomicAdd(&map[pixel * RECORD_WORDS + 1u], 1u);
}
