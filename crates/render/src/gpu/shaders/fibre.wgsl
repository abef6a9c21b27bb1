// Scattering by fibres and by the many fibres around them: twin of cpu/strand_points/fibre.rs and of `PointScatter` in appearance, which explains
// the formulas.

// The tables of `FibreTables`, one after the other, 8 numbers a row: direct light, light that many fibres scattered, many scatterings.
@group(0) @binding(8) var<storage, read> tables: array<vec4f>;

const AZIMUTHS: u32 = 64u;
const ABSORPTIONS: u32 = 64u;
const COSINES: u32 = 16u;
// Vectors of a table.
const TABLE: u32 = 2048u;
const MANY: u32 = 2u * TABLE;
const SMALLEST_COSINE: f32 = 0.05;
const FIBRES_PER_DEPTH: f32 = 1.0 / 0.15;
const LEAST_TRANSMITTANCE: f32 = 1.0 / 510.0;
const OWN_FIBRES: f32 = 0.5;
const FACING_FIBRES: f32 = 0.6;
const MAX_INCLINED: f32 = 0.9396926;
const MAX_FIBRES: f32 = 40.0;
const LARGEST_SOURCE: f32 = 0.25;
const WIDEST: f32 = 20.0;
const BACKSCATTER: f32 = 0.636619772;
const BACKSCATTER_EDGE: f32 = 0.2;
const PI: f32 = 3.14159265;

struct Step { index: u32, fraction: f32 }

fn step_of(x: f32, count: u32) -> Step {
    let place = clamp(x, 0.0, f32(count - 1u));
    let index = min(u32(place), count - 2u);
    return Step(index, place - f32(index));
}

fn cosine_step(cos_o: f32) -> Step {
    let low = sqrt(SMALLEST_COSINE);
    return step_of(f32(COSINES - 1u) * (sqrt(max(cos_o, 0.0)) - low) / (1.0 - low), COSINES);
}

struct Row { a: vec4f, b: vec4f }

// A row between four, of a table whose rows of one cosine are `width`.
fn row_at(table: u32, eye: Step, along: Step, width: u32) -> Row {
    let first = table + 2u * (eye.index * width + along.index);
    let next = first + 2u * width;
    let a = mix(tables[first], tables[first + 2u], along.fraction);
    let b = mix(tables[first + 1u], tables[first + 3u], along.fraction);
    let c = mix(tables[next], tables[next + 2u], along.fraction);
    let d = mix(tables[next + 1u], tables[next + 3u], along.fraction);
    return Row(mix(a, c, eye.fraction), mix(b, d, eye.fraction));
}

fn many_row(eye: Step, sigma: f32) -> Row {
    let root = min(sqrt(max(sigma, 0.0)), 1e9);
    return row_at(MANY, eye, step_of(f32(ABSORPTIONS - 1u) * root / (1.0 + root), ABSORPTIONS), ABSORPTIONS);
}

struct Lobe { inverse: f32, scale: f32 }

fn quick_lobe(v: f32) -> Lobe {
    let w = 1.0 / v;
    let above = 0.5 + w * (0.7770005 + w * (0.5457964 + w * 0.386785));
    let below = 1.0 + w * (0.5239108 + w * 0.386785);
    return Lobe(w, above / below);
}

fn lobe_at(lobe: Lobe, light: vec2f, tilted: vec2f) -> f32 {
    let both = light.y * tilted.y;
    let x = both * lobe.inverse;
    let above = 1.0 + x * (0.3868723 + x * (0.2559611 + x * 0.17248243));
    let below = 1.0 + x * (2.3868723 + x * (2.5988084 + x * (1.298065 + x * 1.083739)));
    return exp(max((both - light.x * tilted.x - 1.0) * lobe.inverse, -87.0)) * sqrt(above / below) * lobe.scale;
}

// What a point scatters toward the eye, without any light.
struct Scatter {
    eye: Step,
    sin_v: f32,
    cos_v: f32,
    // Sine and cosine of the eye's inclination, tilted for each lobe.
    tilted_r: vec2f,
    tilted_tt: vec2f,
    tilted_trt: vec2f,
    tilted_rest: vec2f,
    sigma: vec3f,
    forward: vec3f,
    spread: vec3f,
    backscatter: vec3f,
    backscatter_variance: f32,
    rest: vec3f,
    albedo: vec3f,
}

fn tilted(p: u32, sin_v: f32, cos_v: f32) -> vec2f {
    let tilt = vec2f(frame.lobes[p].sin_tilt, frame.lobes[p].cos_tilt);
    return vec2f(sin_v * tilt.y + cos_v * tilt.x, abs(cos_v * tilt.y - sin_v * tilt.x));
}

fn scatter_of(t: vec3f, v: vec3f, absorption: vec3f) -> Scatter {
    let sin_v = clamp(dot(t, v), -MAX_INCLINED, MAX_INCLINED);
    let cos_v = sqrt(1.0 - sin_v * sin_v);
    let eye = cosine_step(cos_v);
    let sigma = clamp(absorption, vec3f(0.0), vec3f(1e6));
    let r = many_row(eye, sigma.r);
    let g = many_row(eye, sigma.g);
    let b = many_row(eye, sigma.b);
    let variance = frame.lobes[0].variance;
    let returned = vec3f(r.b.x, g.b.x, b.b.x);
    let weights = returned + 1e-9;
    let widths = vec3f(r.b.y, g.b.y, b.b.y);
    let mean = dot(weights, widths) / dot(weights, vec3f(1.0));
    return Scatter(
        eye,
        sin_v,
        cos_v,
        tilted(0u, sin_v, cos_v),
        tilted(1u, sin_v, cos_v),
        tilted(2u, sin_v, cos_v),
        tilted(3u, sin_v, cos_v),
        sigma,
        vec3f(r.a.x, g.a.x, b.a.x),
        variance * vec3f(r.a.z, g.a.z, b.a.z),
        BACKSCATTER * returned,
        clamp(variance * mean, 0.0, WIDEST),
        vec3f(r.b.w, g.b.w, b.b.w),
        vec3f(r.a.x + r.a.y, g.a.x + g.a.y, b.a.x + b.a.y),
    );
}

// The distributions of TT or TRT for the three channels.
fn faded(first: f32, length: f32, curve: f32, sigma: vec3f) -> vec3f {
    return first * exp(max(-length * sigma / (1.0 + curve * sigma), vec3f(-87.0)));
}

// Radiance toward the eye per irradiance of a light toward which `l` points. `lit` is the transmittance of the hair before it.
fn scattered(s: Scatter, t: vec3f, l: vec3f, v: vec3f, lit: f32, specular: f32, turn: f32) -> vec3f {
    let sin_l = clamp(dot(t, l), -1.0, 1.0);
    let cos_l = sqrt(max(1.0 - sin_l * sin_l, 0.0));
    let phi = acos(clamp((dot(l, v) - sin_l * s.sin_v) / max(cos_l * s.cos_v, 1e-4), -1.0, 1.0));
    let light = vec2f(sin_l, cos_l);
    let azimuth = step_of(phi * (f32(AZIMUTHS - 1u) / PI), AZIMUTHS);
    let direct = row_at(0u, s.eye, azimuth, AZIMUTHS);
    let after = row_at(TABLE, s.eye, azimuth, AZIMUTHS);

    let crossed = -FIBRES_PER_DEPTH * log(max(lit, LEAST_TRANSMITTANCE));
    let facing = max(dot(l, v), 0.0);
    let n = clamp(crossed - OWN_FIBRES - FACING_FIBRES * facing * facing, 0.0, MAX_FIBRES);
    let unhit = exp(-n);
    let reached = exp(-n * (1.0 - s.forward));
    let psi = clamp(reached - unhit, vec3f(0.0), vec3f(1.0));
    let hit = clamp(1.0 - unhit / reached, vec3f(0.0), vec3f(1.0));
    let added = clamp(s.spread * (n * s.forward + 1e-4) / (hit + 1e-4), vec3f(0.0), vec3f(WIDEST));
    let share = psi + 1e-6;
    let x = dot(share, added) / dot(share, vec3f(1.0));

    // A large source widens the lobes, and so does the turn of the strand.
    let wider = LARGEST_SOURCE * (1.0 - specular) + turn;
    let v_r = frame.lobes[0].variance + wider;
    let v_tt = frame.lobes[1].variance + wider;
    let v_trt = frame.lobes[2].variance + wider;
    let once_r = lobe_at(quick_lobe(v_r), light, s.tilted_r);
    let once_tt = lobe_at(quick_lobe(v_tt), light, s.tilted_tt);
    let once_trt = lobe_at(quick_lobe(v_trt), light, s.tilted_trt);
    let once_rest = lobe_at(quick_lobe(frame.lobes[3].variance + wider), light, s.tilted_rest);
    let after_r = lobe_at(quick_lobe(v_r + x), light, s.tilted_r);
    let after_tt = vec3f(
        lobe_at(quick_lobe(v_tt + added.r), light, s.tilted_tt),
        lobe_at(quick_lobe(v_tt + added.g), light, s.tilted_tt),
        lobe_at(quick_lobe(v_tt + added.b), light, s.tilted_tt),
    );
    let after_trt = lobe_at(quick_lobe(v_trt + x), light, s.tilted_trt);

    let same_side = clamp(0.5 + (0.5 * PI - phi) * (0.5 / BACKSCATTER_EDGE), 0.0, 1.0);
    let back_once = same_side * lobe_at(quick_lobe(s.backscatter_variance), light, s.tilted_rest);
    let back_after = same_side * lobe_at(quick_lobe(s.backscatter_variance + x), light, s.tilted_rest);

    let strength = frame.many_scattering;
    let single = once_r * direct.a.x
        + once_tt * faded(direct.a.y, direct.a.z, direct.a.w, s.sigma)
        + once_trt * faded(direct.b.x, direct.b.y, direct.b.z, s.sigma)
        + once_rest * s.rest;
    let global = after_r * after.a.x
        + after_tt * faded(after.a.y, after.a.z, after.a.w, s.sigma)
        + after_trt * (faded(after.b.x, after.b.y, after.b.z, s.sigma) + s.rest);
    return unhit * (single + strength * s.backscatter * back_once)
        + strength * psi * (global + s.backscatter * back_after);
}
