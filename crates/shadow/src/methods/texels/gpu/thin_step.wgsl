// Lines one texel wide: a step is one fragment.

fn put_step(by_row: bool, major: i32, minor: f32, depth: f32, length: f32, width: f32) {
    put(texel_of(by_row, major, i32(minor)), depth, u32(length * width * WEIGHT_ONE + 0.5));
}
