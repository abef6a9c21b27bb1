// Optical depth before a point: it rises linearly through each bin.

fn depth_before(texel: u32, depth: f32) -> f32 {
    var sum = 0.0;
    for (var j = 0u; j < texels.parts; j++) {
        let bin = 3u * (texel * texels.parts + j);
        let weight = map[bin + 2u];
        if (weight > 0u) {
            let part = (depth - bitcast<f32>(map[bin])) * bitcast<f32>(map[bin + 1u]);
            sum += depth_of_weight(f32(weight)) * clamp(part, 0.0, 1.0);
        }
    }
    return sum;
}
