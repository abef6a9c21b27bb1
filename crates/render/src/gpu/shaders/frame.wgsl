// The uniform of all passes. Twin of `FrameUniform` and `LightUniform` in uniform.rs.

const MAX_LIGHTS: u32 = 4u;

struct LightUniform {
    // The direction in which the light travels.
    direction: vec3f,
    // The fraction that contributes to highlights.
    specular: f32,
    // Colour times intensity.
    radiance: vec3f,
    // The blur of the body's shadow in texels of its map.
    blur: f32,
    // To the clip space of the body's depth map, z in 0..1.
    shadow_from_world: mat4x4f,
    // To the texture of transmittance behind all hair; z is the fraction of the texture's edge that the map of this light uses.
    columns_from_world: mat4x4f,
}

// One of the lobes R, TT, TRT and the rest.
struct LobeUniform {
    sin_tilt: f32,
    cos_tilt: f32,
    variance: f32,
    unused: f32,
}

struct FrameUniform {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
    eye: vec3f,
    light_count: u32,
    // Size in pixels.
    size: vec2f,
    // Pixels that a metre covers at one metre.
    pixels_per_metre: f32,
    // A factor.
    exposure: f32,
    background_top: vec3f,
    shows_ground: u32,
    background_bottom: vec3f,
    // Texels along an edge of the body's depth maps.
    shadow_texels: f32,
    // Absorption of the hair, and its variation between strands.
    absorption: vec3f,
    variation: f32,
    // Absorption of the hair with the colours of its strands: the mean at the roots, and over the whole length.
    root_absorption: vec3f,
    // Full width of a drawn strand in metres.
    strand_width: f32,
    mean_absorption: vec3f,
    opacity: f32,
    primary_strength: f32,
    secondary_strength: f32,
    primary_exponent: f32,
    secondary_exponent: f32,
    // The index of the strand at which the width of fading strands would reach 0, and the slope of their widths.
    fade_end: f32,
    fade_slope: f32,
    // 1 if stored strands are drawn.
    points_per_strand: u32,
    drawn_points: u32,
    // Share of grey strands, share of lightened locks, how much less pigment those have, strength of many scatterings.
    grey: f32,
    highlights: f32,
    lightening: f32,
    many_scattering: f32,
    tip_lightening: f32,
    @align(16) lobes: array<LobeUniform, 4>,
    // The corner of the grid of ambient light, and the reciprocal of its cells' edge.
    grid_corner: vec3f,
    cells_per_metre: f32,
    // Light from all directions: see `Surround` in appearance.
    surround: array<vec4f, 9>,
    lights: array<LightUniform, 4>,
}

@group(0) @binding(0) var<uniform> frame: FrameUniform;
@group(0) @binding(1) var body_depth: texture_depth_2d_array;
@group(0) @binding(15) var compare: sampler_comparison;
@group(0) @binding(2) var hair_columns: texture_2d_array<f32>;
@group(0) @binding(3) var linear_clamp: sampler;
// Light from all directions among the hair: red, green and blue at hair, and the share that arrives at skin. See ambient.rs.
@group(0) @binding(22) var ambient_cells: texture_3d<f32>;

// The number of lights. Code per light is unrolled, because software adapters load a number with a constant index once for all threads
// of a vector.
override LIGHTS: u32 = MAX_LIGHTS;

// The components of the unit normal `n` along u, v and toward light `i`.
fn lean_of(i: u32, n: vec3f) -> vec3f {
    let light = frame.lights[i];
    let rows = transpose(light.shadow_from_world);
    let u = dot(n, normalize(rows[0].xyz));
    let v = -dot(n, normalize(rows[1].xyz));
    return vec3f(u, v, -dot(n, light.direction));
}

// The colour of much hair: see `HairLook::body_color` in groom.
const BODY_PATH: f32 = 5.2;
const STRETCH: f32 = 0.7;
const SURFACE_SHARE: f32 = 0.012;

// Taps of a soft shadow on a surface. Six taps would show bands.
const SURFACE_TAPS: u32 = 12u;

// The fraction of light `i` that the body lets through to `p`, which is moved `bias` metres toward the light first. The taps are on a
// disc in the plane of the surface, given by `lean`, so that a flat surface does not shadow itself.
fn body_light(i: u32, p: vec3f, lean: vec3f, bias: f32, taps: u32) -> f32 {
    let light = frame.lights[i];
    let at = light.shadow_from_world * vec4f(p - light.direction * bias, 1.0);
    let uv = at.xy * vec2f(0.5, -0.5) + 0.5;
    if (any(uv < vec2f(0.0)) || any(uv > vec2f(1.0))) {
        return 1.0;
    }
    // Texels around a position are nearer by the slope of the plane over one texel. The slope is limited, because at grazing angles it
    // would be too large for other surfaces.
    let texel = 1.0 / frame.shadow_texels;
    let z = at.z - texel * (abs(lean.x) + abs(lean.y)) / max(lean.z, 0.25);
    let turn = lean.xy / (1.0 + max(lean.z, 0.0));
    // A golden-angle disc: uniform for any number of taps, and the same for every pixel, so that it does not flicker. The map is as deep
    // as it is wide, so its three coordinates can be rotated together.
    let radius = max(light.blur, 1.0) * texel;
    var direction = vec2f(1.0, 0.0);
    var sum = 0.0;
    var k = 0u;
    loop {
        let tap = radius * sqrt((f32(taps - k) - 0.5) / f32(taps)) * direction;
        let deeper = dot(tap, lean.xy);
        // Nothing behind the far end of the map blocks light.
        sum += textureSampleCompareLevel(body_depth, compare, uv + tap - turn * deeper, i, min(z + deeper, 1.0));
        // If the five outermost taps agree, so do the inner ones.
        if (k == 4u && taps > 8u && (sum == 0.0 || sum == 5.0)) {
            return sum / 5.0;
        }
        direction = vec2f(
            direction.x * -0.737368878 - direction.y * 0.675490294,
            direction.x * 0.675490294 + direction.y * -0.737368878,
        );
        k++;
        // Tested at the end: on software adapters a test at the beginning costs an empty iteration.
        continuing {
            break if k >= taps;
        }
    }
    return sum / f32(taps);
}

// The transmittance of all hair for light `i`, for a point behind it.
fn columns_light(i: u32, p: vec3f) -> f32 {
    let at = (frame.lights[i].columns_from_world * vec4f(p, 1.0)).xyz;
    if (any(at.xy < vec2f(0.0)) || any(at.xy > vec2f(at.z))) {
        return 1.0;
    }
    // Nothing outside this map's part of the texture is read.
    let last = vec2f(at.z) - 0.5 / vec2f(textureDimensions(hair_columns));
    return textureSampleLevel(hair_columns, linear_clamp, min(at.xy, last), i, 0.0).r;
}

// Light from all directions on a surface with the unit normal `n`: irradiance over pi.
fn ambient(n: vec3f) -> vec3f {
    let sum = frame.surround[0].xyz
        + frame.surround[1].xyz * n.y
        + frame.surround[2].xyz * n.z
        + frame.surround[3].xyz * n.x
        + frame.surround[4].xyz * (1.5 * n.y * n.y - 0.5)
        + frame.surround[5].xyz * (n.y * n.z)
        + frame.surround[6].xyz * (n.y * n.x)
        + frame.surround[7].xyz * (n.z * n.z - n.x * n.x)
        + frame.surround[8].xyz * (2.0 * n.x * n.z);
    return max(sum, vec3f(0.0));
}

// The mean light from all directions: irradiance over pi, averaged over the directions of surfaces.
fn ambient_mean() -> vec3f {
    return max(frame.surround[0].xyz, vec3f(0.0));
}

// Light from all directions at a position among the hair.
fn ambient_at(p: vec3f) -> vec4f {
    let place = (p - frame.grid_corner) * frame.cells_per_metre;
    return textureSampleLevel(ambient_cells, linear_clamp, place / vec3f(textureDimensions(ambient_cells)), 0.0);
}
