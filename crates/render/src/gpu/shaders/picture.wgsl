// The finished picture: hair over the body over the background.

@group(0) @binding(4) var normals: texture_multisampled_2d<u32>;
@group(0) @binding(5) var colors: texture_multisampled_2d<f32>;
// Depths of the body in the four samples of each pixel; 0 where there is none.
@group(0) @binding(6) var<storage, read> behind: array<vec4f>;
@group(0) @binding(7) var<storage, read> corners: array<vec4f>;
// The hair of each pixel: its light times what it covers, and the share of the light behind that comes through, as four
// half floats.
@group(0) @binding(8) var<storage, read> hair_layer: array<vec2u>;
// Red, green, blue and alpha of each pixel.
@group(0) @binding(9) var<storage, read_write> screen: array<u32>;

// Light that comes through hair and is no longer worth lighting what is behind: a fourth of a step of 8 bits.
const UNSEEN: f32 = 1.0 / 1024.0;

// Where the four samples of a pixel lie in it: WebGPU's.
const SAMPLES: array<vec2f, 4> =
    array<vec2f, 4>(vec2f(0.375, 0.125), vec2f(0.875, 0.375), vec2f(0.125, 0.625), vec2f(0.625, 0.875));

fn lit_sample(pixel: vec2u, k: i32, depth: f32, words: vec4u) -> vec3f {
    var places = SAMPLES;
    let ndc = ((vec2f(pixel) + places[k]) / frame.size_scale_exposure.xy - 0.5) * vec2f(2.0, -2.0);
    let world = frame.world_from_clip * vec4f(ndc, depth, 1.0);
    let folded = unpack2x16snorm(words.x | (words.y << 16u));
    let z = 1.0 - abs(folded.x) - abs(folded.y);
    let turned = (1.0 - abs(folded.yx)) * select(vec2f(-1.0), vec2f(1.0), folded >= vec2f(0.0));
    let normal = vec3f(select(turned, folded, z >= 0.0), z);
    let color = textureLoad(colors, pixel, k);
    let hair = unpack4x8unorm(words.z | (words.w << 16u));
    return shade_surface(Surface(world.xyz / world.w, normal, color, hair));
}

// The body and what is behind it.
fn behind_hair(i: u32, pixel: vec2u) -> vec3f {
    let depths = behind[i];
    if (all(depths == vec4f(0.0))) {
        return backdrop(pixel);
    }
    var words: array<vec4u, 4>;
    var depth = array<f32, 4>(depths.x, depths.y, depths.z, depths.w);
    var sum = vec3f(0.0);
    var free = 0.0;
    for (var k = 0; k < 4; k++) {
        if (depth[k] == 0.0) {
            free += 0.25;
            continue;
        }
        words[k] = textureLoad(normals, pixel, k);
        // A triangle has the same words in all of its samples.
        var first = true;
        for (var j = 0; j < k; j++) {
            first = first && !(depth[j] != 0.0 && all(words[j] == words[k]));
        }
        if (!first) {
            continue;
        }
        var share = 0.25;
        for (var j = k + 1; j < 4; j++) {
            if (depth[j] != 0.0 && all(textureLoad(normals, pixel, j) == words[k])) {
                share += 0.25;
            }
        }
        sum += share * lit_sample(pixel, k, depth[k], words[k]);
    }
    if (free > 0.0) {
        sum += free * backdrop(pixel);
    }
    return sum;
}

@compute @workgroup_size(64)
fn picture(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let size = vec2u(frame.size_scale_exposure.xy);
    if (i >= size.x * size.y) {
        return;
    }
    let pixel = vec2u(i % size.x, i / size.x);
    let rg = unpack2x16float(hair_layer[i].x);
    let bt = unpack2x16float(hair_layer[i].y);
    var light = vec3f(rg, bt.x);
    if (bt.y > UNSEEN) {
        light += bt.y * behind_hair(i, pixel);
    }
    screen[i] = pack4x8unorm(vec4f(tone_map(light, pixel), 1.0));
}
