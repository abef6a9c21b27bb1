// A record consists of words: both ends of the depth range and the weight of all hair (floats), then four moments: floats, or integers
// of 16 bits in two words. Until all fragments are added, moments are shares of the weight as integers in four words of scratch memory.

// Whether moments have 16 bits.
override SHORT: bool = false;

fn record_of(texel: u32) -> u32 {
    return texel * (HEADER + select(4u, 2u, SHORT));
}

// z of a depth, −1 to 1 between the ends of a range.
fn warped(near: f32, far: f32, depth: f32) -> f32 {
    return part_of(near, far, depth) * 2.0 - 1.0;
}
