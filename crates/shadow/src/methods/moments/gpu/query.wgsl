// Optical depth before a point.

fn depth_before(texel: u32, depth: f32) -> f32 {
    let record = record_of(texel);
    let near = bitcast<f32>(map[record]);
    let far = bitcast<f32>(map[record + 1u]);
    // 0 without hair.
    let all = depth_of_weight(bitcast<f32>(map[record + 2u]));
    let first = record + HEADER;
    var means: array<f32, 8>;
    for (var k = 0u; k < ORDER; k++) {
        if (SHORT) {
            let words = map[first + k];
            means[2u * k] = from_short(words & 0xffffu);
            means[2u * k + 1u] = from_short(words >> 16u);
        } else {
            means[2u * k] = bitcast<f32>(map[first + 2u * k]);
            means[2u * k + 1u] = bitcast<f32>(map[first + 2u * k + 1u]);
        }
    }
    let z = warped(near, far, depth);
    var system = system_of(means);
    // Without a distribution, even hair between the ends.
    var share = select(0.5 * (z + 1.0), share_before(&system, z), system.is_solvable);
    share = select(share, 1.0, depth > far);
    return select(all * share, 0.0, depth <= near);
}
