// Optical depth before a point, interpolated between the ends of two slices.

fn depth_before(texel: u32, depth: f32) -> f32 {
    let place = slice_of(depth);
    let slice = u32(place.x);
    let record = texel * texels.parts;
    var before = 0.0;
    if (slice > 0u) {
        before = depth_of_weight(f32(map[record + slice - 1u]));
    }
    return before + (depth_of_weight(f32(map[record + slice])) - before) * min(place.y, 1.0);
}
