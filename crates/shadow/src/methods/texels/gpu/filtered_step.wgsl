// Lines one texel wide, or pre-filtered lines if `texels.prefiltered` is set: then a step is one fragment in each of the two
// nearest texels across the longer axis, which share its weight.

fn put_step(by_row: bool, major: i32, minor: f32, depth: f32, length: f32) {
    let weight = u32(length * WEIGHT_ONE + 0.5);
    let filtered = texels.prefiltered != 0u;
    let at = select(minor, minor - 0.5, filtered);
    let low = floor(at);
    let second = select(0u, u32(length * WEIGHT_ONE * (at - low) + 0.5), filtered);
    for (var k = 0u; k < select(1u, 2u, filtered); k++) {
        put(texel_of(by_row, major, i32(low) + i32(k)), depth, select(weight - second, second, k == 1u));
    }
}
