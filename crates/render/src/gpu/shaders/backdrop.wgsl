// The background: a graded backdrop that runs into the ground without a seam, with the shadows on the ground.

@group(1) @binding(0) var<storage, read> corners: array<vec4f>;

struct Screen {
    @builtin(position) position: vec4f,
    @location(0) ndc: vec2f,
}

@vertex
fn screen(@builtin(vertex_index) vertex: u32) -> Screen {
    let ndc = vec2f(f32((vertex << 1u) & 2u), f32(vertex & 2u)) * 2.0 - 1.0;
    return Screen(vec4f(ndc, 0.0, 1.0), ndc);
}

// Difference of two corners' light that is not worth a look between them: half a step of 8 bits.
const ALIKE: f32 = 1.0 / 512.0;

// The share of the light that is left on the ground at a pixel.
fn light_at(pixel: vec2u, ndc: vec2f) -> vec3f {
    let columns = corner_columns();
    let first = pixel.y / CELL * columns + pixel.x / CELL;
    let a = corners[first];
    let b = corners[first + 1u];
    let c = corners[first + columns];
    let d = corners[first + columns + 1u];
    // Corners on both sides of the horizon do not speak for what is between them.
    let spread = max(max(abs(a - b), abs(a - c)), abs(a - d));
    if (all(spread < vec4f(ALIKE))) {
        return a.rgb;
    }
    return ground_light(ndc).rgb;
}

@fragment
fn backdrop(in: Screen) -> @location(0) vec4f {
    let down = 0.5 - 0.5 * in.ndc.y;
    // A soft pool of light behind the figure.
    let pool = 1.0 - 0.28 * smoothstep(0.2, 1.5, length(in.ndc * vec2f(0.8, 0.7)));
    var color = mix(frame.background_top.xyz, frame.background_bottom.xyz, smoothstep(0.0, 1.0, down)) * pool;
    if (frame.ambient_up_ground.w > 0.5) {
        color *= light_at(vec2u(in.position.xy), in.ndc);
    }
    return vec4f(color, 1.0);
}
