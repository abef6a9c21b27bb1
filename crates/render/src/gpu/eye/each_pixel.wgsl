// Calls `pixel_pass(pixel)` for every pixel of the area.

@compute @workgroup_size(64)
fn each_pixel(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i < area_pixels()) {
        pixel_pass(i);
    }
}
