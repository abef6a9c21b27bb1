// A record holds the weight before the end of each slice, one word each. `texels.parts`: slices.

// The slice that contains a depth, and the position in it, 0 to 1; above 1 for depths behind all slices.
fn slice_of(depth: f32) -> vec2f {
    let slices = depth * f32(texels.parts);
    let slice = min(floor(slices), f32(texels.parts - 1u));
    return vec2f(slice, slices - slice);
}
