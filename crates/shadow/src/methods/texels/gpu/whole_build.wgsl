// How they are built: fragments add their shares of the weight of all hair, as integers, whose sums are exact in any order.

// The integer of a share of 1.
const SHARE_ONE: f32 = 536870912.0;

// Both ends of the range of a texel.
fn ends_of(texel: u32) -> vec2f {
    if (OF_MAP) {
        return vec2f(0.0, 1.0);
    }
    return vec2f(near_of(texel), far_of(texel));
}

// The share of a fragment in the weight of its texel, in steps of 1 / SHARE_ONE.
fn share_of(texel: u32, weight: u32) -> f32 {
    let all = weight_of(texel);
    return select(0.0, f32(weight) / all, all > 0.0) * SHARE_ONE;
}

// The number of a sum of shares.
fn number_of(sum: u32) -> f32 {
    return f32(bitcast<i32>(sum)) * (1.0 / SHARE_ONE);
}

// Writes the words before the function.
fn write_header(texel: u32, record: u32) {
    let ends = ends_of(texel);
    atomicStore(&map[record], bitcast<u32>(ends.x));
    atomicStore(&map[record + 1u], bitcast<u32>(ends.y));
    atomicStore(&map[record + 2u], bitcast<u32>(weight_of(texel)));
}
