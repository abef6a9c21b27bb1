// The nearest depth of the body in each pixel: most fragments need no more of it.

@group(0) @binding(0) var depths: texture_depth_multisampled_2d;
@group(0) @binding(1) var nearest: texture_storage_2d<r32float, write>;

@compute @workgroup_size(64)
fn read_depths(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let size = textureDimensions(depths);
    if (i >= size.x * size.y) {
        return;
    }
    let at = vec2u(i % size.x, i / size.x);
    let depth = max(
        max(textureLoad(depths, at, 0), textureLoad(depths, at, 1)),
        max(textureLoad(depths, at, 2), textureLoad(depths, at, 3)),
    );
    textureStore(nearest, at, vec4f(depth, 0.0, 0.0, 0.0));
}
