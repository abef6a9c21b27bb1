// The body's depth in the four samples of each pixel, where compute kernels can read it quickly.

@group(0) @binding(0) var depths: texture_depth_multisampled_2d;
@group(0) @binding(1) var<storage, read_write> behind: array<vec4f>;

@compute @workgroup_size(64)
fn read_depths(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let size = textureDimensions(depths);
    if (i >= size.x * size.y) {
        return;
    }
    let at = vec2u(i % size.x, i / size.x);
    behind[i] = vec4f(
        textureLoad(depths, at, 0),
        textureLoad(depths, at, 1),
        textureLoad(depths, at, 2),
        textureLoad(depths, at, 3),
    );
}
