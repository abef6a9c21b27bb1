// The clusters of a frame, for all kernels that draw them. A column is the stack of hair shell volumes between two ribs and two
// sections; its layers are quadrilaterals. Twin of cpu/clusters.

// Twin of `ClusterUniform` in mod.rs.
struct ClusterUniform {
    eye: vec3f,
    // The optical depth of a strand times the length of the arc that it lies in, metres.
    depth: f32,
    // The pixels that may show hair: left and top, right and bottom.
    low: vec2f,
    high: vec2f,
    // Hair shell volumes around, along, and layers of each cluster.
    around: u32,
    along: u32,
    layers: u32,
    count: u32,
    // Radius of the core.
    core: f32,
    shadow_strength: f32,
    // The finest level of detail.
    finest: f32,
    // 1 for the published lighting.
    as_published: u32,
    // Strengths of the matt part and of both highlights of the published light.
    matt: f32,
    primary: f32,
    secondary: f32,
    // How strongly records vary the light of strands.
    detail: f32,
    // Entries of a map, the pattern of the literal look-up, and threads per triangle.
    entries: u32,
    pattern: u32,
    lanes: u32,
    // The light whose entries are placed.
    light: u32,
    // Unit vectors toward the lights.
    to_lights: array<vec4f, 4>,
}

// The parts of light that are told apart: ambient light, and four lights.
const LIT_PARTS: u32 = 5u;

// Where an outer and an inner rib cross a section. Twin of `Vertex` in cpu/clusters/vertices.rs.
struct ClusterVertex {
    // Pixels from the left and top, and depth, on the inner ring.
    inner: vec3f,
    // Sine of the angle between the eye and the hair; negative if the point must not be drawn.
    sin_view: f32,
    outer: vec3f,
    // One over the length of the outer arc to the next rib, 1/metres.
    inverse_arc: f32,
    // Azimuths of the lights and of the eye, from the outward normal.
    light_angles: vec4f,
    view_angle: f32,
    cos_view: f32,
    // Ambient light and that of each light on the inner and the outer ring, as half floats: red and green, blue.
    lit: array<vec4u, LIT_PARTS>,
}

@group(0) @binding(10) var<uniform> clusters: ClusterUniform;

const TAU: f32 = 6.2831853;

fn columns() -> u32 {
    return clusters.count * clusters.around * clusters.along;
}

fn quads() -> u32 {
    return columns() * clusters.layers;
}

// The four vertices of a column: both ribs at its lower section, then at its upper one.
fn corners(column: u32) -> vec4u {
    let around = clusters.around;
    let along = clusters.along;
    let all = column / along;
    let rib = all % around;
    let cluster_first = (all - rib) * (along + 1u);
    let here = cluster_first + rib * (along + 1u) + column % along;
    let next = cluster_first + (rib + 1u) % around * (along + 1u) + column % along;
    return vec4u(here, next, here + 1u, next + 1u);
}

// Where the outer surface of a layer lies between the rings: 1 on the outer one.
fn outward(layer: u32) -> f32 {
    return f32(layer + 1u) / f32(max(clusters.layers, 1u));
}

// The radius of that surface in the unit disk.
fn radius_of(layer: u32) -> f32 {
    let core = clusters.core;
    return core + (1.0 - core) * outward(layer);
}

// The radius in the middle of a layer, by which its density is measured.
fn middle_radius_of(layer: u32) -> f32 {
    let core = clusters.core;
    return core + (1.0 - core) * (f32(layer) + 0.5) / f32(max(clusters.layers, 1u));
}

// The thickness of a layer as a fraction of its radius.
fn thickness_of(layer: u32) -> f32 {
    return (1.0 - clusters.core) / (f32(clusters.layers) * radius_of(layer));
}

// Between four corners.
fn bilinear(values: vec4f, u: f32, t: f32) -> f32 {
    let ribs = values.xz + (values.yw - values.xz) * u;
    return ribs.x + (ribs.y - ribs.x) * t;
}

fn between(a: f32, b: f32, t: f32) -> f32 {
    return a + (b - a) * t;
}
