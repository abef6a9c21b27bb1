// A record consists of words: both ends of the depth range and the weight of all hair (floats), then two coefficients per term. Until
// all fragments are added, coefficients are shares of the weight as integers.

// Terms besides the constant one.
override TERMS: u32 = 7u;

fn record_of(texel: u32) -> u32 {
    return texel * (HEADER + 2u * TERMS);
}

// The place of a depth in the period of the series.
fn place_of(near: f32, far: f32, depth: f32) -> f32 {
    let margin = 0.5 / f32(TERMS + 1u);
    return margin + part_of(near, far, depth) * (1.0 - 2.0 * margin);
}
