// Calls `texel_pass(texel)` for every texel.

@compute @workgroup_size(64)
fn each_texel(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i < texels.count) {
        texel_pass(i);
    }
}
