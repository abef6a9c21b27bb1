// The textures of one material, for the passes that draw the triangles of a body material by material.

// Twin of `MaterialDraw` in gpu/surface_textures.rs.
struct MaterialDraw {
    // For the textures of base colour, normals, emitted light, colour in shade and roughness: the axes of the transform of coordinates; then its
    // translation, which coordinates it transforms (0 or 1), and 1 if there is such a texture.
    axes: array<vec4f, 5>,
    moves: array<vec4f, 5>,
    tint: vec3f,
    // Index of the material.
    index: u32,
    emissive: vec3f,
    // 0 lit, 1 unlit, 2 toon.
    model: u32,
    shade: vec3f,
    slope: f32,
    // Opacity from which a mask is there; below 0 for blended surfaces.
    cutoff: f32,
}

@group(1) @binding(0) var<uniform> material: MaterialDraw;
@group(1) @binding(1) var base_texture: texture_2d<f32>;
@group(1) @binding(2) var normal_texture: texture_2d<f32>;
@group(1) @binding(3) var emissive_texture: texture_2d<f32>;
@group(1) @binding(4) var shade_texture: texture_2d<f32>;
@group(1) @binding(5) var roughness_texture: texture_2d<f32>;
@group(1) @binding(6) var base_sampler: sampler;
@group(1) @binding(7) var normal_sampler: sampler;
@group(1) @binding(8) var emissive_sampler: sampler;
@group(1) @binding(9) var shade_sampler: sampler;
@group(1) @binding(10) var roughness_sampler: sampler;

const BASE: u32 = 0u;
const NORMAL: u32 = 1u;
const EMISSIVE: u32 = 2u;
const SHADE: u32 = 3u;
const ROUGHNESS: u32 = 4u;

// Both sets of coordinates, and how they change from pixel to pixel.
struct Coordinates {
    at: vec4f,
    dx: vec4f,
    dy: vec4f,
}

fn is_textured(use_of: u32) -> bool {
    return material.moves[use_of].w > 0.5;
}

// The coordinates that a texture uses, with its transform; as directions without its translation.
fn direction_on(use_of: u32, both: vec4f) -> vec2f {
    let one = select(both.xy, both.zw, material.moves[use_of].z > 0.5);
    return material.axes[use_of].xy * one.x + material.axes[use_of].zw * one.y;
}

fn place_on(use_of: u32, both: vec4f) -> vec2f {
    return direction_on(use_of, both) + material.moves[use_of].xy;
}

// The logarithm to base 2 of the longer step from pixel to pixel in texels: twin of the function in textures/lookup.rs.
fn level_of_detail(dx: vec2f, dy: vec2f, size: vec2u) -> f32 {
    let a = dx * vec2f(size);
    let b = dy * vec2f(size);
    let longest = max(dot(a, a), dot(b, b));
    return select(-20.0, 0.5 * log2(min(longest, 1e30)), longest > 1e-12);
}

fn level_on(image: texture_2d<f32>, use_of: u32, c: Coordinates) -> f32 {
    return max(level_of_detail(direction_on(use_of, c.dx), direction_on(use_of, c.dy), textureDimensions(image)), 0.0);
}

fn look_up(image: texture_2d<f32>, by: sampler, use_of: u32, c: Coordinates) -> vec4f {
    return textureSampleLevel(image, by, place_on(use_of, c.at), level_on(image, use_of, c));
}

// Whether a surface with holes is there, given the opacity of the vertices. Far away `threshold` decides: the levels of the texture of a
// mask but the first have the share of it that is shown. Twin of `Opacity` in cpu/surface/materials.rs.
fn is_there(c: Coordinates, own: f32, threshold: f32) -> bool {
    var opacity = 1.0;
    var far = 0.0;
    if (is_textured(BASE)) {
        let lod = level_on(base_texture, BASE, c);
        opacity = textureSampleLevel(base_texture, base_sampler, place_on(BASE, c.at), lod).a;
        far = min(lod, f32(min(textureNumLevels(base_texture) - 1u, 1u)));
    }
    if (material.cutoff < 0.0) {
        return own * opacity >= threshold;
    }
    let value = opacity * mix(own, select(0.0, 1.0, own >= material.cutoff), far);
    return value >= mix(material.cutoff, threshold, far);
}
