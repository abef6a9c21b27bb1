// How many fragments each pixel has.

fn take(pixel: u32, fragment: Fragment) {
    atomicAdd(&map[pixel * RECORD_WORDS + 1u], 1u);
}
