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

// A light that stands somewhere. Twin of `StandingUniform` in standing.rs.
struct StandingUniform {
    position: vec3f,
    // 0 for a directional light.
    radius: f32,
    // Unit axes, by which a side of a cube is told.
    axes: array<vec4f, 3>,
    // The middle of a spot's cone, and what makes the cosine of the angle to it 0 at the outer and 1 at the inner angle.
    cone_axis: vec3f,
    cone_scale: f32,
    cone_offset: f32,
    // Tangent of a texel of the body's depth map.
    texel: f32,
    // Views of the body, and maps of transmittance behind all hair: 1 or 6.
    body_sides: u32,
    column_sides: u32,
    // See `LightUniform`; both are divided by the fourth coordinate.
    shadow_from_world: array<mat4x4f, 6>,
    columns_from_world: array<mat4x4f, 6>,
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
    // See backdrop.wgsl.
    background_form: u32,
    @align(16) lobes: array<LobeUniform, 4>,
    // The corner of the grid of ambient light, and the reciprocal of its cells' edge.
    grid_corner: vec3f,
    cells_per_metre: f32,
    // Light from all directions: see `Surround` in appearance.
    surround: array<vec4f, 9>,
    lights: array<LightUniform, 4>,
    standing: array<StandingUniform, 4>,
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

// Whether any light stands somewhere.
override STANDING: bool = false;

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
// Taps where the edge is wide: twelve would show as that many edges beside each other.
const WIDE_TAPS: u32 = 48u;
// From where on an edge is wide: texels of the map, and metres of the lamp's radius. Twins of `WIDE_BLUR` and `WIDE_LAMP` in uniform.
const WIDE_BLUR: f32 = 12.0;
const WIDE_LAMP: f32 = 0.25;

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

// The side of light `i` that a position belongs to, of `sides`.
fn side_at(i: u32, p: vec3f, sides: u32) -> u32 {
    let q = p - frame.standing[i].position;
    let v = vec3f(
        dot(frame.standing[i].axes[0].xyz, q),
        dot(frame.standing[i].axes[1].xyz, q),
        dot(frame.standing[i].axes[2].xyz, q),
    );
    return select(0u, side_of(v), sides > 1u);
}

// The layer of a side of light `i` in arrays of textures: twin of `layer_of` in standing.rs.
fn layer_of(i: u32, side: u32) -> u32 {
    return select(MAX_LIGHTS + 5u * i + side - 1u, i, side == 0u);
}

// The unit vector toward a light, and the share of its brightness that arrives if nothing is between.
struct Arriving { toward: vec3f, share: f32 }

fn arriving(i: u32, p: vec3f) -> Arriving {
    if (STANDING) {
        if (frame.standing[i].radius > 0.0) {
            let way = frame.standing[i].position - p;
            let far = length(way);
            let toward = way / max(far, 1e-6);
            let near = max(far, frame.standing[i].radius);
            let cosine = -dot(toward, frame.standing[i].cone_axis);
            let t = clamp(cosine * frame.standing[i].cone_scale + frame.standing[i].cone_offset, 0.0, 1.0);
            return Arriving(toward, t * t * (3.0 - 2.0 * t) / (near * near));
        }
    }
    return Arriving(-frame.lights[i].direction, 1.0);
}

// Twins of the constants of `Light` in picture.
const BLOCKER_METRES: f32 = 0.1;
const MAX_SOFTNESS: f32 = 0.1;

// The position in the view of the body from light `i`, its depth, and the layer of the view. Beside all views the fourth is negative.
fn body_place(i: u32, p: vec3f) -> vec4f {
    let side = side_at(i, p, frame.standing[i].body_sides);
    let at = frame.standing[i].shadow_from_world[side] * vec4f(p, 1.0);
    let inside = at.w > 0.0 && abs(at.x) <= at.w && abs(at.y) <= at.w;
    let ndc = at.xyz / max(at.w, 1e-9);
    return vec4f(ndc.xy * vec2f(0.5, -0.5) + 0.5, ndc.z, select(-1.0, f32(layer_of(i, side)), inside));
}

// As `body_light`, for a light that stands somewhere. The taps are on a disc perpendicular to the unit vector `n`.
fn body_light_standing(i: u32, p: vec3f, n: vec3f, bias: f32, taps: u32) -> f32 {
    if (body_place(i, p).w < 0.0) {
        return 1.0;
    }
    let way = frame.standing[i].position - p;
    let far = max(length(way), 1e-6);
    let l = way / far;
    let texel = far * frame.standing[i].texel;
    let cosine = max(dot(n, l), 0.0);
    // Texels around a position are nearer by the slope of the plane over one texel; see `body_light`.
    let slope = 1.414 * sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, 0.25);
    let start = p + l * (bias + texel * slope);
    // Duff et al. 2017, "Building an Orthonormal Basis, Revisited", as `Vec3::any_orthonormal_pair`.
    let sign = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let y = vec3f(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    let z = vec3f(b, sign + n.y * n.y * a, -n.y);
    let soft = frame.standing[i].radius * BLOCKER_METRES / max(far, frame.standing[i].radius);
    let radius = max(min(soft, MAX_SOFTNESS), texel);
    var direction = vec2f(1.0, 0.0);
    var sum = 0.0;
    for (var k = 0u; k < taps; k++) {
        let tap = radius * sqrt((f32(k) + 0.5) / f32(taps)) * direction;
        let place = body_place(i, start + y * tap.x + z * tap.y);
        let layer = u32(max(place.w, 0.0));
        let lit = textureSampleCompareLevel(body_depth, compare, place.xy, layer, min(place.z, 1.0));
        sum += select(lit, 1.0, place.w < 0.0);
        direction = vec2f(
            direction.x * -0.737368878 - direction.y * 0.675490294,
            direction.x * 0.675490294 + direction.y * -0.737368878,
        );
    }
    return sum / f32(taps);
}

// The fraction of light `i` that the body lets through to a position on a surface with the unit normal `n`.
fn past_body(i: u32, p: vec3f, n: vec3f, bias: f32, taps: u32) -> f32 {
    if (STANDING) {
        if (frame.standing[i].radius > 0.0) {
            return body_light_standing(i, p, n, bias, taps);
        }
    }
    return body_light(i, p, lean_of(i, n), bias, taps);
}

// The taps of the soft shadow of light `i` on the body.
fn body_taps(i: u32) -> u32 {
    var wide = frame.lights[i].blur > WIDE_BLUR;
    if (STANDING) {
        if (frame.standing[i].radius > 0.0) {
            wide = frame.standing[i].radius > WIDE_LAMP;
        }
    }
    return select(SURFACE_TAPS, WIDE_TAPS, wide);
}

// The transmittance of all hair for light `i`, for a point behind it.
fn columns_light(i: u32, p: vec3f) -> f32 {
    if (STANDING) {
        if (frame.standing[i].radius > 0.0) {
            return columns_light_standing(i, p);
        }
    }
    let at = (frame.lights[i].columns_from_world * vec4f(p, 1.0)).xyz;
    if (any(at.xy < vec2f(0.0)) || any(at.xy > vec2f(at.z))) {
        return 1.0;
    }
    // Nothing outside this map's part of the texture is read.
    let last = vec2f(at.z) - 0.5 / vec2f(textureDimensions(hair_columns));
    return textureSampleLevel(hair_columns, linear_clamp, min(at.xy, last), i, 0.0).r;
}

fn columns_light_standing(i: u32, p: vec3f) -> f32 {
    let side = side_at(i, p, frame.standing[i].column_sides);
    let at = frame.standing[i].columns_from_world[side] * vec4f(p, 1.0);
    let uv = at.xy / max(at.w, 1e-9);
    if (at.w <= 0.0 || any(uv < vec2f(0.0)) || any(uv > vec2f(at.z))) {
        return 1.0;
    }
    let last = vec2f(at.z) - 0.5 / vec2f(textureDimensions(hair_columns));
    return textureSampleLevel(hair_columns, linear_clamp, min(uv, last), layer_of(i, side), 0.0).r;
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
