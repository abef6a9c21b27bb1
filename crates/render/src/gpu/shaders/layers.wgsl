// A picture as linear light, with depth and transmittance. Twin of cpu/layers.rs.

// Red, green, blue and alpha of each pixel of the picture, exposed.
@group(0) @binding(16) var<storage, read_write> light_layer: array<vec4f>;
// Depth in metres and transmittance of each pixel.
@group(0) @binding(17) var<storage, read_write> data_layer: array<vec2f>;

// Twin of `Layers::NOTHING_METRES` and `NEAR_METRES`.
const NOTHING_METRES: f32 = 1e10;
const NEAR_METRES: f32 = 0.02;

fn put_light(i: u32, light: vec3f, alpha: f32) {
    light_layer[i] = vec4f(light * frame.exposure, alpha);
}

fn samples_of(pixel: vec2u) -> vec4f {
    return vec4f(
        textureLoad(depths, pixel, 0),
        textureLoad(depths, pixel, 1),
        textureLoad(depths, pixel, 2),
        textureLoad(depths, pixel, 3),
    );
}

// The plain background, which is in no list.
@compute @workgroup_size(64)
fn layer_background(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let size = picture_size();
    if (i < size.x * size.y) {
        let pixel = vec2u(i % size.x, i / size.x);
        let whole = OVER_BACKGROUND && frame.background_form != PICTURE;
        put_light(i, select(vec3f(0.0), graded(pixel), whole), select(0.0, 1.0, whole));
        data_layer[i] = vec2f(NOTHING_METRES, 1.0);
    }
}

// The pixels of a list, like `picture_lit`.
@compute @workgroup_size(64)
fn layer_lit(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let size = picture_size();
    let count = atomicLoad(&list_count[LIST]);
    for (var k = id.x; k < count; k += groups.x * 64u) {
        let i = listed[place_in_list(LIST, k, size.x * size.y)];
        let pixel = vec2u(i % size.x, i / size.x);
        let hair = hair_of(pixel);
        var alpha = 1.0;
        if (!OVER_BACKGROUND) {
            let free = dot(select(vec4f(0.25), vec4f(0.0), samples_of(pixel) > vec4f(0.0)), vec4f(1.0));
            alpha = clamp(1.0 - hair.w * free, 0.0, 1.0);
        } else if (frame.background_form == PICTURE) {
            alpha = clamp(1.0 - open_share(pixel, hair.w), 0.0, 1.0);
        }
        put_light(i, hair.rgb + hair.w * behind_hair(pixel), alpha);
    }
}

// The least coverage of hair with which a pixel has a mean; less is rounding.
const LEAST_SHARE: f32 = 1e-6;

// The mean of the values of a pixel whose hair has values and 1 in place of colours: their quotient, whatever multiplies both.
fn mean_of(hair: vec4f) -> f32 {
    return hair.r / max(hair.g, LEAST_SHARE);
}

// Runs when the hair layer has transmittance and 1 in place of colours.
@compute @workgroup_size(64)
fn layer_transmittance(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i < hair_area.z * hair_area.w) {
        let pixel = hair_area.xy + vec2u(i % hair_area.z, i / hair_area.z);
        let hair = hair_of(pixel);
        let mean = clamp(mean_of(hair), 0.0, 1.0);
        let through = clamp(1.0 - (1.0 - hair.w) * (1.0 - mean), 0.0, 1.0);
        data_layer[pixel.y * picture_size().x + pixel.x].y = select(1.0, through, hair.g > LEAST_SHARE);
    }
}

// Runs when the hair layer has the bits of the depth of the nearest strand.
@compute @workgroup_size(64)
fn layer_depth(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let size = picture_size();
    if (i >= size.x * size.y) {
        return;
    }
    let pixel = vec2u(i % size.x, i / size.x);
    let body = samples_of(pixel);
    var near = max(max(body.x, body.y), max(body.z, body.w));
    let place = pixel - hair_area.xy;
    if (place.x < hair_area.z && place.y < hair_area.w) {
        near = max(near, bitcast<f32>(hair_layer[place.y * hair_area.z + place.x].x));
    }
    if (near > 0.0) {
        data_layer[i].x = NEAR_METRES / near;
    }
}
