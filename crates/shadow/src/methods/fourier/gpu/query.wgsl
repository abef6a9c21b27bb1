// Optical depth before a point: the integral of the series.

fn depth_before(texel: u32, depth: f32) -> f32 {
    let record = record_of(texel);
    let near = bitcast<f32>(map[record]);
    let far = bitcast<f32>(map[record + 1u]);
    // 0 without hair.
    let all = depth_of_weight(bitcast<f32>(map[record + 2u]));
    let place = place_of(near, far, depth);
    let one = turn(place);
    var turned = one;
    var share = place;
    for (var k = 0u; k < TERMS; k++) {
        let at = record + HEADER + 2u * k;
        share += bitcast<f32>(map[at]) * turned.y + bitcast<f32>(map[at + 1u]) * (1.0 - turned.x);
        turned = turn_on(turned, one);
    }
    // All hair at one depth lies behind it.
    share = select(0.0, share, far > near && share > 0.0);
    share = select(share, 1.0, depth > far);
    return select(all * share, 0.0, depth <= near);
}
