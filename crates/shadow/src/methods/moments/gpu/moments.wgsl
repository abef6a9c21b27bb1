// A record consists of words: both ends of the depth range and the weight of all hair (floats), then the means of the functions of
// means.wgsl: floats, or integers of 16 bits, two in a word. Until all fragments are added, means are shares of the weight as integers
// in scratch memory, a word each.

// Half of the number of means.
override ORDER: u32 = 2u;
// Whether moments are trigonometric.
override TURNED: bool = false;
// Whether means have 16 bits.
override SHORT: bool = false;

fn record_of(texel: u32) -> u32 {
    return texel * (HEADER + select(2u * ORDER, ORDER, SHORT));
}

// z of a depth, −1 to 1 between the ends of a range.
fn warped(near: f32, far: f32, depth: f32) -> f32 {
    return part_of(near, far, depth) * 2.0 - 1.0;
}
