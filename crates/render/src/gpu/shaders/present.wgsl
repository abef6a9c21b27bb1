// Copies a finished image into the texture that the window shows. If a list of fragments was too short, strands are missing from the
// image: the image before it is shown again, until the frame is drawn with longer lists.

struct Present {
    size: vec2u,
    // The number of lists, and whether there is an image before of the same size.
    lists: u32,
    has_before: u32,
    // The fragments that fit into each list: that of the image first, then those of shadow maps.
    room: array<vec4u, 2>,
}

@group(0) @binding(0) var<uniform> present: Present;
// Four bytes per pixel.
@group(0) @binding(1) var<storage, read> pixels: array<u32>;
// The head of each list.
@group(0) @binding(2) var<storage, read> heads: array<vec4u>;
@group(0) @binding(3) var before: texture_2d<f32>;
@group(0) @binding(4) var shown: texture_storage_2d<rgba8unorm, write>;

// Whether a list is complete. The second word of the list of the image is its number of fragments; heads of shadow maps are described
// in texels/gpu/list_head.wgsl.
fn is_complete(list: u32) -> bool {
    let head = heads[list];
    let room = present.room[list >> 2u][list & 3u];
    if (list == 0u) {
        return head.y <= room;
    }
    return head.y < 65536u && head.x <= room;
}

@compute @workgroup_size(64)
fn show(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if (index >= present.size.x * present.size.y) {
        return;
    }
    let at = vec2u(index % present.size.x, index / present.size.x);
    var complete = true;
    for (var list = 0u; list < present.lists; list += 1u) {
        complete = complete && is_complete(list);
    }
    if (complete || present.has_before == 0u) {
        textureStore(shown, at, unpack4x8unorm(pixels[index]));
    } else {
        textureStore(shown, at, textureLoad(before, at, 0));
    }
}
