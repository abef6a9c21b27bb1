// The light of the points of ribs, as that of strands, with its parts told apart: ambient light, and then each light. Joined with
// strand_points.wgsl and clusters.wgsl. Twin of `shade_all_parts` in cpu/strand_points.

@group(0) @binding(24) var<storage, read_write> rib_light: array<vec2u>;

fn put_part(i: u32, part: u32, light: vec3f) {
    let limited = min(light, vec3f(MAX_LIGHT));
    rib_light[i * LIT_PARTS + part] = vec2u(pack2x16float(limited.rg), pack2x16float(vec2f(limited.b, 0.0)));
}

@compute @workgroup_size(64)
fn light_ribs(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= drawn_points()) {
        return;
    }
    let point = point_at(i);
    let transmittance = unpack4x8unorm(light_left[i]);
    for (var k = 0u; k < LIGHTS; k++) {
        put_part(i, 1u + k, light_of(k, point, transmittance[k]));
    }
    put_part(i, 0u, ambient_of(point, transmittance));
}
