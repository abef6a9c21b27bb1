// Draws segments as ribbons that face the camera. Below a pixel, width becomes coverage: a strand of 0.2 pixels
// is drawn one pixel wide at a fifth of its opacity, so it neither breaks up nor gains weight as it recedes.

struct ShadedPoint {
    at: vec3f,
    half_width: f32,
    across: vec2f,
    color: vec2u,
}

@group(1) @binding(0) var<storage, read> shaded: array<ShadedPoint>;
@group(1) @binding(1) var<storage, read> order: array<u32>;          // first point of each segment, as drawn

struct Ribbon {
    @builtin(position) position: vec4f,
    // Pixels from the middle of the strand.
    @location(0) offset: f32,
    // Half of the drawn width, pixels.
    @location(1) half_width: f32,
    // Opacity where the strand covers the pixel wholly.
    @location(2) opacity: f32,
    @location(3) color: vec3f,
    @location(4) hash: f32,
}

@vertex
fn ribbon(@builtin(vertex_index) vertex: u32) -> Ribbon {
    let corner = vertex % 6u;
    let first = order[vertex / 6u];
    // Two triangles: (0,-) (0,+) (1,-) and (1,-) (0,+) (1,+).
    let end = u32(corner == 2u || corner == 3u || corner == 5u);
    let side = select(-1.0, 1.0, corner == 1u || corner == 4u || corner == 5u);
    let here = shaded[first + end];
    let other = shaded[first + 1u - end];

    let half_width = max(here.half_width, 0.5);
    let offset = side * (half_width + 0.5);
    let pixel = here.at.xy + here.across * offset;
    let size = frame.size_scale_exposure.xy;
    let ndc = (pixel / size - 0.5) * vec2f(2.0, -2.0);
    let rg = unpack2x16float(here.color.x);
    let ba = unpack2x16float(here.color.y);

    var out: Ribbon;
    out.position = vec4f(ndc, here.at.z, 1.0);
    if (here.half_width < 0.0 || other.half_width < 0.0) {
        out.position = vec4f(2.0, 2.0, 0.0, 1.0);
    }
    out.offset = offset;
    out.half_width = half_width;
    out.opacity = frame.width_opacity_tip_scalp.y * min(here.half_width * 2.0, 1.0);
    out.color = vec3f(rg, ba.x);
    out.hash = ba.y;
    return out;
}

fn coverage(in: Ribbon) -> f32 {
    return clamp(in.half_width + 0.5 - abs(in.offset), 0.0, 1.0);
}

// A drawn strand stands for many hairs: where it is wide enough to show them, it is streaked like them.
fn streaks(in: Ribbon) -> f32 {
    let wide = smoothstep(0.8, 2.0, in.half_width);
    let across = in.offset / max(in.half_width, 1e-3);
    let wave = sin(across * 5.0 + in.hash * 41.0) * 0.6 + sin(across * 11.0 - in.hash * 73.0) * 0.4;
    return wide * wave;
}

// Blended over what is behind, from far to near.
@fragment
fn blended(in: Ribbon) -> @location(0) vec4f {
    let wave = streaks(in);
    let alpha = clamp(in.opacity * coverage(in) * (1.0 + 0.22 * wave), 0.0, 1.0);
    return vec4f(in.color * (1.0 + 0.18 * wave) * alpha, alpha);
}

struct Opaque {
    @location(0) color: vec4f,
    @builtin(sample_mask) samples: u32,
}

// Samples of a pixel that an opacity takes: as many as its fourths, rounded up or down by a noise of the pixel and the
// strand, from one on that is the strand's own. Strands of a pixel take different samples, so that many thin ones add up. Twin of
// `covered_samples` in cpu/hair/list.rs.
fn covered_samples(alpha: f32, pixel: vec2f, hash: f32) -> u32 {
    let noise = fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715))) + 13.7 * hash);
    let count = u32(clamp(floor(alpha * 4.0 + noise), 0.0, 4.0));
    let first = u32(hash * 4.0) & 3u;
    let samples = ((1u << count) - 1u) << first;
    return (samples | (samples >> 4u)) & 15u;
}

// Hides what is behind; the share of samples that a strand takes is its coverage.
@fragment
fn opaque(in: Ribbon) -> Opaque {
    let wave = streaks(in);
    let alpha = clamp(in.opacity * coverage(in) * (1.0 + 0.22 * wave), 0.0, 1.0);
    let samples = covered_samples(alpha, floor(in.position.xy), in.hash);
    return Opaque(vec4f(in.color * (1.0 + 0.18 * wave), 1.0), samples);
}
