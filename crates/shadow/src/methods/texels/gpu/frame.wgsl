// The placement of the texels of a map, and the method's settings. Twin of `TexelUniform` in gpu/mod.rs.

struct TexelUniform {
    // World space.
    anchor: vec3f,
    // The optical depth of a piece of strand whose length across the light is one texel.
    optical_depth: f32,
    // Axes, in texels and in fractions of the depth range, and what is added to each dot product.
    column: vec3f,
    first_column: f32,
    row: vec3f,
    first_row: f32,
    depth: vec3f,
    first_depth: f32,
    // Texels along each edge.
    edge: u32,
    segments: u32,
    // All texels.
    count: u32,
    // Slices, layers or clusters of a texel.
    parts: u32,
    // Of density clustering: 0 for uniform seeds, 1 toward the light, 2 from the histogram.
    seeds: u32,
    // 1 if the deviation of clusters is computed together with their centres.
    merged: u32,
    // 1 for lines shared by two texels, 2 for lines with a Gaussian profile.
    prefiltered: u32,
    // The standard deviation of the profile, in texels.
    line_deviation: f32,
    // Of projected strands: distance of the plane, and distance from the light of depth 0, metres.
    @align(16) plane: f32,
    start: f32,
    // Of approximate deep shadow maps: optical depth for each unit of depth behind the first hair, and the most.
    slope: f32,
    most: f32,
    // Of deep shadow maps: the largest error of a vertex.
    tolerance: f32,
    // Of moments: the share of even light that is mixed in, and the share of a point's own weight that lies before it.
    bias: f32,
    overestimation: f32,
    // Of deep opacity maps: the start of each layer relative to the first fragment, and 1 over its thickness. Of Fourier opacity maps:
    // the factor of each term.
    @align(16) starts: array<vec4f, 4>,
    per_depth: array<vec4f, 4>,
}

// Whether strands are projected from a light: then the fourth coordinate of a point is a factor on the width of its strand, and points
// are projected before they are looked up.
override PROJECTED: bool = false;

@group(0) @binding(0) var<uniform> texels: TexelUniform;

// The weight of a fragment is an integer: 1024 for a piece of strand one texel long.
const WEIGHT_ONE: f32 = 1024.0;

// The optical depth of a sum of weights.
fn depth_of_weight(weight: f32) -> f32 {
    return weight * (texels.optical_depth / WEIGHT_ONE);
}

// Column and row in texels, and depth along the light, 0 to 1 for the hair.
fn texel_from_world(p: vec3f) -> vec3f {
    let d = p - texels.anchor;
    return vec3f(
        (d.x * texels.column.x + d.y * texels.column.y) + d.z * texels.column.z,
        (d.x * texels.row.x + d.y * texels.row.y) + d.z * texels.row.z,
        (d.x * texels.depth.x + d.y * texels.depth.y) + d.z * texels.depth.z,
    ) + vec3f(texels.first_column, texels.first_row, texels.first_depth);
}
