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
    return select(ALL_LIGHT, light, frame.shows_ground != 0u);
}

// The packed light on the ground at a pixel.
fn light_at(pixel: vec2u) -> u32 {
    return cells[pixel.y / CELL * (corner_columns() - 1u) + pixel.x / CELL];
}

fn ndc_of(pixel: vec2u) -> vec2f {
    return ((vec2f(pixel) + 0.5) / frame.size - 0.5) * vec2f(2.0, -2.0);
}

// How much darker the background is far from the pool of light behind the figure.
const POOL_DEPTH: f32 = 0.6;
// Exponent of the pool's bell: it is half as strong at a distance of 0.88 from its middle, where 1 is half the height of a
// square image.
const POOL_FALL: f32 = -1.3;
// Height of the pool's middle: head and shoulders are above the middle of the image.
const POOL_Y: f32 = 0.12;

// Twins of `background_form` in uniform.rs.
const STUDIO: u32 = 0u;
const VERTICAL: u32 = 2u;
const RADIAL: u32 = 3u;

// The background without the ground.
fn graded(pixel: vec2u) -> vec3f {
    let ndc = ndc_of(pixel);
    let down = smoothstep(0.0, 1.0, 0.5 - 0.5 * ndc.y);
    if (frame.background_form != STUDIO) {
        let aspect = frame.size.x / frame.size.y;
        let outward = smoothstep(0.0, 1.0, length(ndc * vec2f(aspect, 1.0)) / length(vec2f(aspect, 1.0)));
        if (frame.background_form == RADIAL) {
            return mix(frame.background_bottom, frame.background_top, outward);
        }
        return mix(frame.background_top, frame.background_bottom, select(0.0, down, frame.background_form == VERTICAL));
    }
    // Half as elongated as the image.
    let wide = sqrt(frame.size.x / frame.size.y);
    let from_middle = vec2f(ndc.x * wide, ndc.y - POOL_Y);
    // A bell has no edge: where a ramp begins or ends, the eye sees a ring.
    let pool = 1.0 - POOL_DEPTH * (1.0 - exp2(POOL_FALL * dot(from_middle, from_middle)));
    return mix(frame.background_top, frame.background_bottom, down) * pool;
}
