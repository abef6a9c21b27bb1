// Projects and shades every strand point once.

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

@group(0) @binding(4) var<storage, read> points: array<vec4f>;
@group(0) @binding(5) var<storage, read> details: array<u32>;        // see `pack_detail` in strand_details.rs
@group(0) @binding(6) var<storage, read> light_left: array<u32>;     // four 8-bit transmittances
@group(0) @binding(7) var<storage, read_write> shaded: array<ShadedPoint>;

// Colours of single strands: see `PointColours::words` in strand_details.rs.
@group(0) @binding(23) var<storage, read> strand_colors: array<u32>;

// The number of points that are drawn; the buffers may hold more.
fn drawn_points() -> u32 {
    return frame.drawn_points;
}

// The width with which a strand is drawn: see `thin` in cpu/strand_points/mod.rs.
fn thin(width: f32) -> f32 {
    let opacity = frame.opacity;
    let narrow = (1.0 - exp(-opacity * width)) / max(opacity, 1e-3);
    return select(width, narrow + (width - narrow) * smoothstep(0.5, 2.0, width), frame.points_per_strand > 1u);
}

// The width of the strand of point `i` as a share of the full width: the last of fine strands fade.
fn share_of_strand(i: u32) -> f32 {
    let strand = i / max(frame.points_per_strand, 1u);
    return clamp((frame.fade_end - f32(strand)) * frame.fade_slope, 0.0, 1.0);
}

struct Projected { pixel: vec2f, depth: f32, w: f32 }

fn project(p: vec3f) -> Projected {
    let clip = frame.clip_from_world * vec4f(p, 1.0);
    let w = max(clip.w, 1e-4);
    let ndc = clip.xyz / w;
    let pixel = (ndc.xy * vec2f(0.5, -0.5) + 0.5) * frame.size;
    return Projected(pixel, ndc.z, clip.w);
}

// How hair is shaded. Twin of `HairShading` in groom.
const FIBRE: u32 = 0u;
const TWO_HIGHLIGHTS: u32 = 1u;
const KAJIYA_KAY: u32 = 2u;
override SHADING: u32 = FIBRE;

// Whether strands have colours of their own.
override COLORED: bool = false;

// The largest half float. See cpu/strand_points/mod.rs.
const MAX_LIGHT: f32 = 65504.0;

// See pigment.rs in groom.
const WHITENING: f32 = 97.381;
const UNPIGMENTED: f32 = 0.03;
const PAINTED_FROM: f32 = 0.2;

// A point to shade: its position, the unit tangent, the unit vector toward the eye, and the colours or the scattering of the strand there.
struct Point { p: vec3f, t: vec3f, v: vec3f, color: StrandColor, scatter: Scatter, turn: f32 }

// The part of `pigment_of` by which strands differ by nature.
fn varied(shade: f32) -> f32 {
    return max(1.0 + frame.variation * (2.0 * shade - 1.0), 0.0);
}

// What is kept of the look's absorption at the fraction `along` of the strand of point `i`, and what is added to it. Twin of
// `colour_along` in groom.
const COLOR_SAMPLES: u32 = 8u;

fn color_at(i: u32, along: f32) -> vec4f {
    let place = along * f32(COLOR_SAMPLES - 1u);
    let sample = min(u32(place), COLOR_SAMPLES - 2u);
    let first = strand_colors[i / max(frame.points_per_strand, 1u)] + 4u * sample;
    let a = vec4u(strand_colors[first], strand_colors[first + 1u], strand_colors[first + 2u], strand_colors[first + 3u]);
    let b = vec4u(strand_colors[first + 4u], strand_colors[first + 5u], strand_colors[first + 6u], strand_colors[first + 7u]);
    return mix(bitcast<vec4f>(a), bitcast<vec4f>(b), place - f32(sample));
}

// Factor on the absorption of a point.
fn pigment_of(detail: u32, along: f32, shade: f32) -> f32 {
    let lock = f32(detail >> 26u) / 64.0;
    let lightened = 1.0 - frame.tip_lightening * smoothstep(0.2, 1.0, along);
    let whitened = select(1.0, UNPIGMENTED, fract(shade * WHITENING) < frame.grey);
    let painted = select(0.0, smoothstep(0.0, PAINTED_FROM, along), lock < frame.highlights);
    return varied(shade) * lightened * whitened * (1.0 - frame.lightening * painted);
}

// Like `body_light` for points without a surface: three taps on a disc perpendicular to the light.
fn body_light_on_strand(k: u32, p: vec3f) -> f32 {
    if (STANDING) {
        if (frame.standing[k].radius > 0.0) {
            let way = frame.standing[k].position - p;
            return body_light_standing(k, p, way / max(length(way), 1e-6), 0.006, 3u);
        }
    }
    let light = frame.lights[k];
    // Roots lie on the skin: the bias prevents the skin under a strand from shadowing it.
    let at = light.shadow_from_world * vec4f(p - light.direction * 0.006, 1.0);
    let uv = at.xy * vec2f(0.5, -0.5) + 0.5;
    let radius = max(light.blur, 1.0) / frame.shadow_texels;
    let z = min(at.z, 1.0);
    let first = radius * sqrt(2.5 / 3.0) * vec2f(1.0, 0.0);
    let second = radius * sqrt(1.5 / 3.0) * vec2f(-0.737368878, 0.675490294);
    let third = radius * sqrt(0.5 / 3.0) * vec2f(0.0874257, -0.9961710);
    let sum = textureSampleCompareLevel(body_depth, compare, uv + first, k, z)
        + textureSampleCompareLevel(body_depth, compare, uv + second, k, z)
        + textureSampleCompareLevel(body_depth, compare, uv + third, k, z);
    let outside = any(uv < vec2f(0.0)) || any(uv > vec2f(1.0));
    return select(sum / 3.0, 1.0, outside);
}

// The light that a point reflects toward the eye from light `k`, given the transmittance of hair.
fn light_of(k: u32, point: Point, lit: f32) -> vec3f {
    let light = frame.lights[k];
    let source = arriving(k, point.p);
    let body = body_light_on_strand(k, point.p) * source.share;
    let toward = source.toward;
    let specular = light.specular;
    if (SHADING == FIBRE) {
        return light.radiance * body * scattered(point.scatter, point.t, toward, point.v, lit, specular, point.turn);
    }
    if (SHADING == KAJIYA_KAY) {
        return light.radiance * (lit * body)
            * published_strand_light(point.t, toward, point.v, point.color.body, specular);
    }
    return light.radiance * (lit * body)
        * strand_light(point.t, toward, point.v, point.color, specular, lit);
}

// Variance that the turn of a strand adds: twin of `turn_variance` in cpu/strand_points.
fn turn_variance(a: vec3f, b: vec3f) -> f32 {
    let lengths = dot(a, a) * dot(b, b);
    let cosine = select(1.0, dot(a, b) * inverseSqrt(max(lengths, 1e-30)), lengths > 1e-30);
    return 2.0 / 3.0 * max(1.0 - cosine, 0.0);
}

// Point `i` as it is shaded.
fn point_at(i: u32) -> Point {
    let detail = details[i];
    let along = f32((detail >> 8u) & 0xffu) / 255.0;
    let shade = f32((detail >> 16u) & 0xffu) / 255.0;
    let first = (detail >> 24u) & 1u;
    let last = (detail >> 25u) & 1u;
    let p = points[i].xyz;
    let before = points[i - (1u - first)].xyz;
    let after = points[i + (1u - last)].xyz;
    var t = after - before;
    t = t / max(length(t), 1e-9);
    let turn = turn_variance(p - before, after - p);
    let to_eye = frame.eye - p;
    let distance = max(length(to_eye), 1e-3);
    let v = to_eye / distance;
    var absorption = frame.absorption * pigment_of(detail, along, shade);
    if (COLORED) {
        let own = color_at(i, along);
        absorption = absorption * own.x + own.yzw * varied(shade);
    }
    var color: StrandColor;
    var scatter: Scatter;
    if (SHADING == FIBRE) {
        scatter = scatter_of(t, v, absorption);
    } else {
        color = strand_color(absorption);
    }
    return Point(p, t, v, color, scatter, turn);
}

// The light from all directions that a point reflects toward the eye, given the transmittance of hair for each light.
fn ambient_of(point: Point, transmittance: vec4f) -> vec3f {
    if (SHADING == FIBRE) {
        return ambient_at(point.p).xyz * point.scatter.albedo;
    }
    if (SHADING == KAJIYA_KAY) {
        // As published, hair does not shadow it.
        return ambient_mean() * point.color.body;
    }
    // Ambient light reaches the inside through the same hair; a part of it always does.
    var inside = 1.0;
    if (LIGHTS > 0u) {
        inside = sqrt(transmittance.x);
    }
    if (LIGHTS > 1u) {
        inside += sqrt(transmittance.y);
    }
    if (LIGHTS > 2u) {
        inside += sqrt(transmittance.z);
    }
    if (LIGHTS > 3u) {
        inside += sqrt(transmittance.w);
    }
    inside /= f32(max(LIGHTS, 1u));
    return ambient(vec3f(0.0, 0.3, 0.0)) * point.color.body * (0.22 + 0.78 * inside);
}

@compute @workgroup_size(64)
fn shade_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let thread = id.x + id.y * groups.x * 64u;
    let count = drawn_points();
    // Surplus threads repeat the last point: on software adapters code after a branch is slow.
    let i = min(thread, count - 1u);
    let detail = details[i];
    let taper = f32(detail & 0xffu) / 255.0;
    let shade = f32((detail >> 16u) & 0xffu) / 255.0;
    let first = (detail >> 24u) & 1u;
    let last = (detail >> 25u) & 1u;
    let before = points[i - (1u - first)].xyz;
    let after = points[i + (1u - last)].xyz;

    let here = project(points[i].xyz);
    let a = project(before);
    let b = project(after);
    var run = b.pixel - a.pixel;
    let run_length = length(run);
    run = select(vec2f(0.0, 1.0), run / max(run_length, 1e-6), run_length > 1e-4);

    let point = point_at(i);
    let transmittance = unpack4x8unorm(light_left[i]);
    var sum = vec3f(0.0);
    if (LIGHTS > 0u) {
        sum += light_of(0u, point, transmittance.x);
    }
    if (LIGHTS > 1u) {
        sum += light_of(1u, point, transmittance.y);
    }
    if (LIGHTS > 2u) {
        sum += light_of(2u, point, transmittance.z);
    }
    if (LIGHTS > 3u) {
        sum += light_of(3u, point, transmittance.w);
    }
    sum += ambient_of(point, transmittance);

    sum = min(sum, vec3f(MAX_LIGHT));
    let width = frame.strand_width * taper * share_of_strand(i) * frame.pixels_per_metre / max(here.w, 1e-3);
    let half_width = 0.5 * thin(width);
    let visible = here.w > 0.02 && a.w > 0.02 && b.w > 0.02;
    if (thread < count) {
        shaded[i] = ShadedPoint(
            vec3f(here.pixel, here.depth),
            select(-1.0, half_width, visible),
            vec2f(-run.y, run.x),
            vec2u(pack2x16float(sum.rg), pack2x16float(vec2f(sum.b, fract(shade * 37.0)))),
        );
    }
}
