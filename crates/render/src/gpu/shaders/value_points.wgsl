// Replaces the colours of shaded points by the transmittance of the first light and 1; see layers.wgsl.

@compute @workgroup_size(64)
fn value_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i < drawn_points()) {
        let left = select(1.0, unpack4x8unorm(light_left[i]).x, frame.eye_lights.w > 0.5);
        // The hash of the strand is kept.
        let hash = shaded[i].color.y & 0xffff0000u;
        shaded[i].color = vec2u(pack2x16float(vec2f(left, 1.0)), hash);
    }
}
