// Optical depth before a point, interpolated between the ends of two layers.

fn depth_before(texel: u32, depth: f32) -> f32 {
    let record = record_of(texel);
    let turned = map[record];
    let behind = depth - bitcast<f32>(~turned);
    if (turned == 0u || behind <= 0.0) {
        return 0.0;
    }
    let layer = layer_of(behind);
    let part = min((behind - start_of(layer)) * per_depth_of(layer), 1.0);
    var before = 0.0;
    if (layer > 0u) {
        before = depth_of_weight(f32(map[record + layer]));
    }
    return before + (depth_of_weight(f32(map[record + layer + 1u])) - before) * part;
}
