// Projects strands onto a plane before a light. Twin of face.rs and strands.rs.

struct ProjectUniform {
    // A point near the hair, world space.
    anchor: vec3f,
    // Segments or points.
    count: u32,
    // Axes: from the light to the middle of the plane, and two along it.
    axis: vec3f,
    // Distance of the plane, metres.
    plane: f32,
    across: vec3f,
    // Hair nearer along the axis is cut off, metres.
    nearest: f32,
    more: vec3f,
    // The largest tangents.
    slope: f32,
    // The anchor, seen from the light along the axes.
    offset: vec3f,
    // Hair within this distance from the light casts no shadow, metres.
    radius: f32,
}

@group(0) @binding(0) var<uniform> face: ProjectUniform;
@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(2) var<storage, read> segments: array<u32>;
@group(0) @binding(3) var<storage, read_write> projected: array<vec4f>;

// A point that no map holds.
const NOWHERE: vec4f = vec4f(1e30, 1e30, 1e30, 0.0);

// Along the axes, from the anchor.
fn along(p: vec3f) -> vec3f {
    let d = p - face.anchor;
    return vec3f(dot(face.axis, d), dot(face.across, d), dot(face.more, d));
}

// Of a point along the axes from the anchor: its distance from the light less that of the anchor, and its place on the plane.
fn placed(d: vec3f) -> vec3f {
    let q = face.offset + d;
    // The difference of the distances, without losing digits where both are large.
    let sum = length(q) + length(face.offset);
    let depth = select(0.0, dot(d, q + face.offset) / sum, sum > 0.0);
    return vec3f(depth, q.yz * (face.plane / q.x));
}

// The part of a segment that remains where `a` at its start and `b` at its end are not negative; empty where the first is not less
// than the second.
fn cut(part: vec2f, a: f32, b: f32) -> vec2f {
    if (a >= 0.0 && b >= 0.0) {
        return part;
    }
    let at = a / (a - b);
    if (a >= 0.0) {
        return vec2f(part.x, min(part.y, at));
    }
    if (b >= 0.0) {
        return vec2f(max(part.x, at), part.y);
    }
    return vec2f(1.0, 0.0);
}

@compute @workgroup_size(64)
fn project_segments(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= face.count) {
        return;
    }
    projected[2u * i] = NOWHERE;
    projected[2u * i + 1u] = NOWHERE;
    let a = along(points[segments[i]].xyz);
    let b = along(points[segments[i] + 1u].xyz);
    let from_light = face.offset + a;
    let to_light = face.offset + b;
    var part = cut(vec2f(0.0, 1.0), from_light.x - face.nearest, to_light.x - face.nearest);
    let first_edge = face.slope * from_light.x;
    let last_edge = face.slope * to_light.x;
    part = cut(part, first_edge - from_light.y, last_edge - to_light.y);
    part = cut(part, first_edge + from_light.y, last_edge + to_light.y);
    part = cut(part, first_edge - from_light.z, last_edge - to_light.z);
    part = cut(part, first_edge + from_light.z, last_edge + to_light.z);
    // False for what is not finite.
    let step = b - a;
    if (!(part.x < part.y && dot(step, step) < 1e12)) {
        return;
    }
    let begin = a + step * part.x;
    let end = select(a + step * part.y, b, part.y >= 1.0);
    let near = face.offset + begin;
    let far = face.offset + end;
    if (length(0.5 * (near + far)) < face.radius) {
        return;
    }
    // See `Face::widening`.
    let u = near.yz / near.x;
    let v = far.yz / far.x;
    let reach = distance(u, v);
    let h = select(0.0, (u.x * v.y - u.y * v.x) / reach, reach > 0.0);
    let wider = face.plane * sqrt(1.0 + h * h);
    projected[2u * i] = vec4f(placed(begin), wider / near.x);
    projected[2u * i + 1u] = vec4f(placed(end), wider / far.x);
}

@compute @workgroup_size(64)
fn project_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= face.count) {
        return;
    }
    projected[i] = NOWHERE;
    let d = along(points[i].xyz);
    let q = face.offset + d;
    // False for NaN.
    let edge = face.slope * q.x;
    if (q.x >= face.nearest && abs(q.y) <= edge && abs(q.z) <= edge && length(q) >= face.radius) {
        // See `Face::narrowing`.
        let t = q.yz / q.x;
        let nearer = face.plane / q.x;
        projected[i] = vec4f(placed(d), nearer * nearer * sqrt(1.0 + dot(t, t)));
    }
}
