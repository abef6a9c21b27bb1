// A small copy of a rectangle of an image: each pixel is the mean of 4 by 4 places.

struct Shrink {
    // The first corner of the rectangle and its size, pixels of the image.
    corner: vec2f,
    size: vec2f,
}

@group(0) @binding(0) var<uniform> shrink: Shrink;
@group(0) @binding(1) var image: texture_2d<f32>;
@group(0) @binding(2) var small: texture_storage_2d<rgba8unorm, write>;

@compute @workgroup_size(64)
fn average(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let sides = textureDimensions(small);
    let index = id.x + id.y * groups.x * 64u;
    if (index >= sides.x * sides.y) {
        return;
    }
    let at = vec2u(index % sides.x, index / sides.x);
    let most = textureDimensions(image) - 1u;
    var sum = vec4f(0.0);
    for (var k = 0u; k < 16u; k += 1u) {
        let part = (vec2f(4u * at + vec2u(k & 3u, k >> 2u)) + 0.5) / vec2f(4u * sides);
        let place = vec2u(shrink.corner + part * shrink.size);
        sum += textureLoad(image, min(place, most), 0);
    }
    textureStore(small, at, sum / 16.0);
}
