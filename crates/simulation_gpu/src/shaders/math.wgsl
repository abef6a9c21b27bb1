// Twins of the functions in `lanes.rs`. Shaders may be compiled as if there were no NaN, so numbers that may be
// infinite or NaN are recognised by their bits.

const LARGEST = 3.4028234e38;

fn greater(a: f32, b: f32) -> f32 {
    return select(a, b, b > a);
}

fn lesser(a: f32, b: f32) -> f32 {
    return select(a, b, b < a);
}

fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

/// Inverse square root to two units in the last place; finite for 0.
fn inv_sqrt(squared: f32) -> f32 {
    let x = lesser(squared, LARGEST);
    let guess = bitcast<f32>(0x5f1ffff9u - (bitcast<u32>(x) >> 1u));
    let near = guess * (1.6819141 - 0.70395225 * x * guess * guess);
    let off = 1.0 - x * near * near;
    return near + near * off * (0.5 + 0.375 * off);
}

fn length_of(v: vec3f) -> f32 {
    return sqrt(dot(v, v));
}

struct Direction {
    unit: vec3f,
    length: f32,
}

/// The unit vector along `v` and its length; `fallback` where it is too short to have a direction.
fn direction_or(v: vec3f, fallback: vec3f) -> Direction {
    let squared = dot(v, v);
    let scale = inv_sqrt(squared);
    return Direction(select(fallback, v * scale, squared > 1e-24), squared * scale);
}

fn turned(turn: vec4f, a: vec3f) -> vec3f {
    let t = 2.0 * cross(turn.xyz, a);
    return a + turn.w * t + cross(turn.xyz, t);
}

/// `turn` followed by the smallest rotation that carries the unit vector `from_unit` to the unit vector `to_unit`.
fn then_smallest(turn: vec4f, from_unit: vec3f, to_unit: vec3f) -> vec4f {
    let v = cross(from_unit, to_unit);
    let w = greater(1.0 + dot(from_unit, to_unit), 1e-4);
    let both_w = w * turn.w - dot(v, turn.xyz);
    let both_v = w * turn.xyz + turn.w * v + cross(v, turn.xyz);
    let scale = inv_sqrt(both_w * both_w + dot(both_v, both_v));
    return vec4f(both_v * scale, both_w * scale);
}

override CREEP: f32;

/// The fraction of a `relative` velocity that friction removes which can change it by `most`.
fn rubbed(most: f32, relative: vec3f) -> f32 {
    return lesser(most * (1.0 / sqrt(dot(relative, relative) + CREEP * CREEP)), 1.0);
}

/// Weights of the eight corners of a cell at the fractions `f`, x fastest.
fn weight_of(n: u32, f: vec3f) -> f32 {
    let x = select(1.0 - f.x, f.x, (n & 1u) != 0u);
    let y = select(1.0 - f.y, f.y, (n & 2u) != 0u);
    let z = select(1.0 - f.z, f.z, (n & 4u) != 0u);
    return x * (y * z);
}

fn blend(a: f32, b: f32, t: f32) -> f32 {
    return a + (b - a) * t;
}

/// Gradient of the trilinear interpolant of eight values, per cell.
fn gradient_of(v: array<f32, 8>, f: vec3f) -> vec3f {
    let x = blend(blend(v[1] - v[0], v[3] - v[2], f.y), blend(v[5] - v[4], v[7] - v[6], f.y), f.z);
    let y = blend(blend(v[2] - v[0], v[3] - v[1], f.x), blend(v[6] - v[4], v[7] - v[5], f.x), f.z);
    let z = blend(blend(v[4] - v[0], v[5] - v[1], f.x), blend(v[6] - v[2], v[7] - v[3], f.x), f.y);
    return vec3f(x, y, z);
}

/// Smoothstep from 0 at 0 to 1 at 1.
fn smooth_of(t: f32) -> f32 {
    let s = lesser(greater(t, 0.0), 1.0);
    return s * s * (3.0 - 2.0 * s);
}
