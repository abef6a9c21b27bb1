// Optical depth before a point: it rises linearly through each slice.

fn depth_before(texel: u32, depth: f32) -> f32 {
    let record = record_of(texel);
    let at = slices_before(map[record], vec2u(map[record + 1u], map[record + 2u]), depth);
    let slice = min(u32(at), texels.parts - 1u);
    let end = f32(map[record + HEADER + slice]);
    let start = select(f32(map[record + HEADER + max(slice, 1u) - 1u]), 0.0, slice == 0u);
    return depth_of_weight(start + (end - start) * (at - f32(slice)));
}
