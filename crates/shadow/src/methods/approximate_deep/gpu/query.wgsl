// Optical depth before a point: even density behind the nearest hair.

fn depth_before(texel: u32, depth: f32) -> f32 {
    let turned = map[texel];
    let behind = depth - bitcast<f32>(~turned);
    // Behind all hair of the map, as much as there can be.
    let before = select(min(behind * texels.slope, texels.most), texels.most, depth > 1.0);
    return select(0.0, before, turned != 0u && behind > 0.0);
}
