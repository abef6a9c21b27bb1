// Copies the depths of the body in the four samples of each pixel of the area to contiguous memory, for one load per fragment.

@group(0) @binding(9) var gathered: texture_storage_2d<rgba32float, write>;

fn pixel_pass(pixel: u32) {
    let place = vec2u(pixel % eye.size.x, pixel / eye.size.x);
    let at = place + eye.corner;
    let four = vec4f(
        textureLoad(samples, at, 0),
        textureLoad(samples, at, 1),
        textureLoad(samples, at, 2),
        textureLoad(samples, at, 3),
    );
    textureStore(gathered, place, four);
}
