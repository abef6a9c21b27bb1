// The hierarchy and the rays. Twin of `TraceUniform` in gpu/mod.rs.

struct TraceUniform {
    // World space.
    anchor: vec3f,
    // Half of the width of a ribbon, metres.
    half_width: f32,
    // The extent of the hair along the axes of the world, from the anchor, metres.
    low: vec3f,
    segments: u32,
    high: vec3f,
    // Segments that there is room for: a power of two. 0 where nothing was built.
    places: u32,
    // Toward a directional light, or where the light stands, from the anchor.
    light: vec3f,
    // Its radius, metres; negative for a directional light.
    radius: f32,
    // Axes across a directional light.
    first_axis: vec3f,
    // Rays along each edge of the square on which they start.
    edge: u32,
    second_axis: vec3f,
    // Optical depth of a ribbon.
    each: f32,
    // Ribbons behind which it is dark.
    most: u32,
    // The radius of the disc on which rays end: metres, or that of a directional light one metre away. 0 for hard shadows.
    spread: f32,
}

@group(0) @binding(0) var<uniform> trace: TraceUniform;

// Segments of a leaf. Twin of hierarchy.rs.
const LEAF: u32 = 4u;
// The key and the number of a place without a segment.
const NONE: u32 = 0xffffffffu;
// Points farther from the anchor than this on any axis are ignored, metres. Twin of bounds.rs.
const FARTHEST: f32 = 1e4;
