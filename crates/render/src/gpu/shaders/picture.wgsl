// The finished picture: hair over the body over the background.

@group(0) @binding(4) var normals: texture_multisampled_2d<u32>;
@group(0) @binding(5) var colors: texture_multisampled_2d<f32>;
// 0 where there is no body.
@group(0) @binding(6) var depths: texture_depth_multisampled_2d;
@group(0) @binding(7) var<storage, read> corners: array<u32>;
// The nearest of the depths in each pixel.
@group(0) @binding(10) var nearest: texture_2d<f32>;
// The part of the picture that may have hair: first column and row, columns and rows.
@group(0) @binding(11) var<uniform> hair_area: vec4u;
// The hair of each pixel of that part: its light times what it covers, and the share of the light behind that comes through, as four
// half floats.
@group(0) @binding(8) var<storage, read> hair_layer: array<vec2u>;
// Red, green, blue and alpha of each pixel.
@group(0) @binding(9) var<storage, read_write> screen: array<u32>;

// Light that comes through hair and is no longer worth lighting what is behind: a fourth of a step of 8 bits.
const UNSEEN: f32 = 1.0 / 1024.0;

// What one sample sees of the body.
struct Seen {
    normal: vec3f,
    depth: f32,
    color_scalp: vec4f,
    hair: vec4f,
}

fn sample_at(pixel: vec2u, k: i32, depth: f32) -> Seen {
    let words = textureLoad(normals, pixel, k);
    let folded = unpack2x16snorm(words.x | (words.y << 16u));
    let z = 1.0 - abs(folded.x) - abs(folded.y);
    let turned = (1.0 - abs(folded.yx)) * select(vec2f(-1.0), vec2f(1.0), folded >= vec2f(0.0));
    let normal = normalize(vec3f(select(turned, folded, z >= 0.0), z));
    return Seen(normal, depth, textureLoad(colors, pixel, k), unpack4x8unorm(words.z | (words.w << 16u)));
}

// Whether two samples lie on one smooth piece of the body, so that they can be lit as one.
fn belong_together(a: Seen, b: Seen) -> bool {
    return dot(a.normal, b.normal) > 0.9 && abs(a.depth - b.depth) < 0.01 * a.depth
        && all(abs(a.color_scalp - b.color_scalp) < vec4f(0.1));
}

// The body and what is behind it. Samples of one smooth piece are lit together, at the middle of the pixel.
fn behind_hair(pixel: vec2u) -> vec3f {
    if (textureLoad(nearest, pixel, 0).x == 0.0) {
        return backdrop(pixel);
    }
    let depth = vec4f(
        textureLoad(depths, pixel, 0),
        textureLoad(depths, pixel, 1),
        textureLoad(depths, pixel, 2),
        textureLoad(depths, pixel, 3),
    );
    let covered = depth > vec4f(0.0);
    var open = dot(select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), covered), vec4u(1u));
    let free = 0.25 * f32(4u - countOneBits(open));
    let ndc = ((vec2f(pixel) + 0.5) / frame.size_scale_exposure.xy - 0.5) * vec2f(2.0, -2.0);
    var sum = vec3f(0.0);
    while (open != 0u) {
        let first = i32(firstTrailingBit(open));
        let one = sample_at(pixel, first, depth[first]);
        open &= open - 1u;
        var together = one;
        var count = 1.0;
        for (var rest = open; rest != 0u; rest &= rest - 1u) {
            let k = i32(firstTrailingBit(rest));
            let other = sample_at(pixel, k, depth[k]);
            if (belong_together(one, other)) {
                together.normal += other.normal;
                together.depth += other.depth;
                together.color_scalp += other.color_scalp;
                together.hair += other.hair;
                count += 1.0;
                open &= ~(1u << u32(k));
            }
        }
        let world = frame.world_from_clip * vec4f(ndc, together.depth / count, 1.0);
        let surface = Surface(
            world.xyz / world.w,
            together.normal,
            together.color_scalp / count,
            together.hair / count,
        );
        sum += 0.25 * count * shade_surface(surface);
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
    var light = vec3f(0.0);
    var through = 1.0;
    let place = pixel - hair_area.xy;
    // Left of and above the area these are very large.
    if (place.x < hair_area.z && place.y < hair_area.w) {
        let hair = hair_layer[place.y * hair_area.z + place.x];
        let bt = unpack2x16float(hair.y);
        light = vec3f(unpack2x16float(hair.x), bt.x);
        through = bt.y;
    }
    if (through > UNSEEN) {
        light += through * behind_hair(pixel);
    }
    screen[i] = pack4x8unorm(vec4f(tone_map(light, pixel), 1.0));
}
