// The nearest and the farthest depth of each pixel.

fn take(pixel: u32, fragment: Fragment) {
    let bits = bitcast<u32>(fragment.depth);
    let record = pixel * RECORD_WORDS;
    if (atomicLoad(&map[record]) < bits) {
        atomicMax(&map[record], bits);
    }
    if (atomicLoad(&map[record + 1u]) < ~bits) {
        atomicMax(&map[record + 1u], ~bits);
    }
}
