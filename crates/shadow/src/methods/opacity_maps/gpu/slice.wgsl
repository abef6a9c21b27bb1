// Weights at the end of each slice, a word each. `texels.whole.x`: slices.

// The slice of a depth and where in it the depth lies, 0 to 1; more than that for depths behind all slices.
fn slice_of(depth: f32) -> vec2f {
    let slices = depth * f32(texels.whole.x);
    let slice = min(floor(slices), f32(texels.whole.x - 1u));
    return vec2f(slice, slices - slice);
}
