// The light on the ground at the corners of cells of pixels.

@group(0) @binding(4) var<storage, read_write> corners: array<u32>;

@compute @workgroup_size(64)
fn ground_corners(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let rows = (u32(frame.size.y) + CELL - 1u) / CELL + 1u;
    if (i >= corner_columns() * rows) {
        return;
    }
    let columns = corner_columns();
    let pixel = vec2f(vec2u(i % columns, i / columns) * CELL);
    let ndc = (pixel / frame.size - 0.5) * vec2f(2.0, -2.0);
    corners[i] = pack_share(ground_light(ndc));
}
