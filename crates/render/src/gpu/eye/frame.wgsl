// The pixels of the picture, shaded strands, and what is behind them. Twin of `EyeUniform` in mod.rs.

struct EyeUniform {
    // First column and row of the area.
    @align(16) corner: vec2u,
    // Columns and rows of the area.
    size: vec2u,
    // Segments, and the capacity of the list of fragments.
    segments: u32,
    room: u32,
    // Opacity of a strand where it covers a pixel completely.
    opacity: f32,
    // Index of the first pixel of the area among the pixels of all areas of the picture.
    first: u32,
    // Threads per segment.
    lanes: u32,
}

struct ShadedPoint {
    // Pixels from the left and top, depth.
    at: vec3f,
    // Half of the width of the strand in pixels; negative if the point must not be drawn.
    half_width: f32,
    // Unit vector perpendicular to the strand on the screen.
    across: vec2f,
    // Colour as four half floats; the fourth is a hash of the strand in 0..1.
    color: vec2u,
}

@group(0) @binding(0) var<uniform> eye: EyeUniform;
@group(0) @binding(1) var<storage, read> shaded: array<ShadedPoint>;
// First point of each segment.
@group(0) @binding(2) var<storage, read> segments: array<u32>;
// Depths of the body in the four samples of each pixel of the area, copied by behind.wgsl.
@group(0) @binding(3) var depths: texture_2d<f32>;
@group(0) @binding(8) var samples: texture_depth_multisampled_2d;
// Records of the modes per pixel of the area, cleared to 0.
@group(0) @binding(4) var<storage, read_write> map: array<atomic<u32>>;
// Fragments of all pixels of the area, `FRAGMENT_WORDS` each.
@group(0) @binding(5) var<storage, read_write> list: array<u32>;
// The number of fragments in the list.
@group(0) @binding(6) var<storage, read_write> total: array<atomic<u32>>;
// The hair of each pixel: its light, premultiplied by coverage, and the fraction of the light behind it that it lets through, as
// four half floats.
@group(0) @binding(7) var<storage, read_write> layer: array<vec2u>;

fn area_pixels() -> u32 {
    return eye.size.x * eye.size.y;
}

fn write_layer(pixel: u32, color: vec3f, through: f32) {
    layer[eye.first + pixel] = vec2u(pack2x16float(min(color.rg, vec2f(65504.0))),
        pack2x16float(vec2f(min(color.b, 65504.0), through)));
}
