// The background: a gradient that merges into the ground without a seam, with shadows on the ground.

// The difference of the light at two corners up to which a cell counts as uniform: half a step of 8 bits.
const ALIKE: f32 = 1.0 / 512.0;

// The light on the ground per cell of pixels, packed like that of corners; the second-highest bit marks uniform cells.
@group(0) @binding(10) var<storage, read_write> cells: array<u32>;

const EVEN_LIGHT: u32 = 0x40000000u;
// Uniform and fully lit.
const ALL_LIGHT: u32 = 0x7fffffffu;

// The light on the ground of a cell, from that at its corners.
fn light_of_cell(cell: vec2u) -> u32 {
    let columns = corner_columns();
    let first = cell.y * columns + cell.x;
    let packed = corners[first];
    let a = unpack_share(packed);
    let b = unpack_share(corners[first + 1u]);
    let c = unpack_share(corners[first + columns]);
    let d = unpack_share(corners[first + columns + 1u]);
    // Corners on both sides of the horizon do not determine the cell.
    let spread = max(max(abs(a - b), abs(a - c)), abs(a - d));
    let light = (packed & 0x3fffffffu) | select(0u, EVEN_LIGHT, all(spread < vec4f(ALIKE)));
    return select(ALL_LIGHT, light, frame.ground_texels.x > 0.5);
}

// The packed light on the ground at a pixel.
fn light_at(pixel: vec2u) -> u32 {
    return cells[pixel.y / CELL * (corner_columns() - 1u) + pixel.x / CELL];
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

