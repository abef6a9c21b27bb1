// Writes the transmittance of the whole hair, texel by texel. A method's query defines `behind_column` and `column_count`.

@group(0) @binding(14) var columns: texture_storage_2d<rgba8unorm, write>;

@compute @workgroup_size(64)
fn write_columns(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let size = column_count();
    if (i >= size * size) {
        return;
    }
    let at = vec2u(i % size, i / size);
    textureStore(columns, at, vec4f(behind_column(at)));
}
