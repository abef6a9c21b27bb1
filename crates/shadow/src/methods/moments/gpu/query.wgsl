// Optical depth before a point.

fn depth_before(texel: u32, depth: f32) -> f32 {
    let record = record_of(texel);
    let near = bitcast<f32>(map[record]);
    let far = bitcast<f32>(map[record + 1u]);
    // 0 without hair.
    let all = depth_of_weight(bitcast<f32>(map[record + 2u]));
    let first = record + HEADER;
    var moments: vec4f;
    if (SHORT) {
        moments = unpack_moments(vec2u(map[first], map[first + 1u]));
    } else {
        moments = bitcast<vec4f>(vec4u(map[first], map[first + 1u], map[first + 2u], map[first + 3u]));
    }
    let z = warped(near, far, depth);
    let system = system_of(moments);
    // Without a distribution, even hair between the ends.
    var share = select(0.5 * (z + 1.0), share_before(system, z), is_solvable(system));
    share = select(share, 1.0, depth > far);
    return select(all * share, 0.0, depth <= near);
}
