// The background: a graded backdrop that runs into the ground without a seam, with the shadows on the ground.

// Difference of two corners' light that is not worth a look between them: half a step of 8 bits.
const ALIKE: f32 = 1.0 / 512.0;

// The share of the light that is left on the ground at a pixel, where the corners of its cell agree on it: w is 1 then.
fn even_light(pixel: vec2u) -> vec4f {
    if (frame.ambient_up_ground.w <= 0.5) {
        return vec4f(1.0);
    }
    let columns = corner_columns();
    let first = pixel.y / CELL * columns + pixel.x / CELL;
    let a = unpack_share(corners[first]);
    let b = unpack_share(corners[first + 1u]);
    let c = unpack_share(corners[first + columns]);
    let d = unpack_share(corners[first + columns + 1u]);
    // Corners on both sides of the horizon do not speak for what is between them.
    let spread = max(max(abs(a - b), abs(a - c)), abs(a - d));
    return vec4f(a.rgb, select(0.0, 1.0, all(spread < vec4f(ALIKE))));
}

fn ndc_of(pixel: vec2u) -> vec2f {
    return ((vec2f(pixel) + 0.5) / frame.size_scale_exposure.xy - 0.5) * vec2f(2.0, -2.0);
}

// The background without the ground.
fn graded(pixel: vec2u) -> vec3f {
    let ndc = ndc_of(pixel);
    let down = 0.5 - 0.5 * ndc.y;
    // A soft pool of light behind the figure.
    let pool = 1.0 - 0.28 * smoothstep(0.2, 1.5, length(ndc * vec2f(0.8, 0.7)));
    return mix(frame.background_top.xyz, frame.background_bottom.xyz, smoothstep(0.0, 1.0, down)) * pool;
}

