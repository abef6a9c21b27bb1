// The placement of the texels of a map, and the method's settings. Twin of `TexelUniform` in gpu/mod.rs.

struct TexelUniform {
    // World space; w is the optical depth of a piece of strand whose length across the light is one texel.
    anchor: vec4f,
    // Axes, in texels and in fractions of the depth range; w is added to the dot product.
    column: vec4f,
    row: vec4f,
    depth: vec4f,
    // Texels along each edge, segments, texels.
    size: vec3u,
    // Settings of the method.
    integers: vec4u,
    floats: array<vec4f, 8>,
}

@group(0) @binding(0) var<uniform> texels: TexelUniform;

// The weight of a fragment is an integer: 1024 for a piece of strand one texel long.
const WEIGHT_ONE: f32 = 1024.0;

// The optical depth of a sum of weights.
fn depth_of_weight(weight: f32) -> f32 {
    return weight * (texels.anchor.w / WEIGHT_ONE);
}

// Column and row in texels, and depth along the light, 0 to 1 for the hair.
fn texel_from_world(p: vec3f) -> vec3f {
    let d = p - texels.anchor.xyz;
    return vec3f(
        (d.x * texels.column.x + d.y * texels.column.y) + d.z * texels.column.z,
        (d.x * texels.row.x + d.y * texels.row.y) + d.z * texels.row.z,
        (d.x * texels.depth.x + d.y * texels.depth.y) + d.z * texels.depth.z,
    ) + vec3f(texels.column.w, texels.row.w, texels.depth.w);
}
