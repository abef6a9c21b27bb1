// Optical depth before a point, from the curve of its texel.

fn depth_before(texel: u32, depth: f32) -> f32 {
    let count = min(map[texel * 2u], NODES);
    let curve = curve_of(texel);
    // The nodes before the point.
    var low = 0u;
    var high = count;
    while (low < high) {
        let middle = (low + high) >> 1u;
        if (bitcast<f32>(map[curve + middle]) < depth) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    if (low == 0u) {
        return 0.0;
    }
    let last_depth = bitcast<f32>(map[curve + low - 1u]);
    var light = bitcast<f32>(map[curve + NODES + low - 1u]);
    if (low < count) {
        let next = bitcast<f32>(map[curve + NODES + low]);
        light += (next - light) * ((depth - last_depth) / (bitcast<f32>(map[curve + low]) - last_depth));
    }
    return select(64.0, -log(max(light, 1e-28)), light > 1e-28);
}
