// One layer of a column: a quadrilateral between two ribs and two sections.

@group(0) @binding(11) var<storage, read> vertices: array<ClusterVertex>;

// Pixels and depth of a vertex on the surface of a layer.
fn place_on(vertex: u32, share: f32) -> vec3f {
    let inner = vertices[vertex].inner;
    return inner + (vertices[vertex].outer - inner) * share;
}

// Azimuths at the corners of a column, without jumps from corner to corner.
fn unwrapped(angles: vec4f) -> vec4f {
    return angles - TAU * round((angles - angles.xxxx) / TAU);
}

// The azimuths of the eye at the corners of a column.
fn view_azimuths(at: vec4u) -> vec4f {
    return unwrapped(vec4f(
        vertices[at.x].view_angle,
        vertices[at.y].view_angle,
        vertices[at.z].view_angle,
        vertices[at.w].view_angle,
    ));
}

// The azimuths of a light there.
fn light_azimuths(at: vec4u, light: u32) -> vec4f {
    return unwrapped(vec4f(
        vertices[at.x].light_angles[light],
        vertices[at.y].light_angles[light],
        vertices[at.z].light_angles[light],
        vertices[at.w].light_angles[light],
    ));
}

fn cosines_of(at: vec4u) -> vec4f {
    return vec4f(vertices[at.x].cos_view, vertices[at.y].cos_view, vertices[at.z].cos_view, vertices[at.w].cos_view);
}

fn sines_of(at: vec4u) -> vec4f {
    return vec4f(vertices[at.x].sin_view, vertices[at.y].sin_view, vertices[at.z].sin_view, vertices[at.w].sin_view);
}

// The way of a ray, whose azimuth has the cosine `cosine`, through a layer as a fraction of that through a flat one: see `curved` in
// cpu/clusters/records.rs.
fn curved(cosine: f32, thickness: f32) -> f32 {
    let c = min(abs(cosine), 1.0);
    let inner = (1.0 - thickness) * (1.0 - thickness) - (1.0 - c * c);
    let way = select(c, c - sqrt(max(inner, 0.0)), inner > 0.0);
    return way * max(c, 1.0 / 6.0) / max(thickness, 1e-3);
}

// Twin of `LocalShadow`.
const SHADOW_OF_MAP: u32 = 0u;
const SHADOW_OF_LAYERS: u32 = 1u;
const SHADOW_LINEAR: u32 = 2u;
const SHADOW_DIRECTIONAL: u32 = 3u;
const SHADOW_EXPONENTIAL: u32 = 4u;
override LOCAL_SHADOW: u32 = SHADOW_OF_MAP;

// The number of lights.
override CLUSTER_LIGHTS: u32 = 4u;

// Maps of `clusters.entries` entries of so many words. The first entry is the number of texels, and one over the mean reflectance under each
// light. The others are texels, with one of each neighbour at the ends: optical depth at both sections, and reflectance there under each
// light, as half floats. Twin of `entry_words` in frame.rs.
fn entry_words() -> u32 {
    return 1u + max(CLUSTER_LIGHTS, 1u);
}

// The first word of the map of a layer.
fn map_of(quad: u32) -> u32 {
    return quad * clusters.entries * entry_words();
}

// The first of the layers that a light crosses on its way to a layer.
fn crossings_of(quad: u32, light: u32) -> u32 {
    return (quad * CLUSTER_LIGHTS + light) * 2u * clusters.layers;
}
