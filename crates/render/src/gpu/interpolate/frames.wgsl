// The moving frame of each wisp, one thread per wisp: transported along the mean of its guides by the smallest rotations. Twin of
// `WispCurve::place` in lovelock-groom.

// Twin of `Instant` in mod.rs.
struct Instant {
    // Columns of the rotation from head space to world space.
    turn_x: vec4f,
    turn_y: vec4f,
    turn_z: vec4f,
    guide_points: u32,
    points_per_guide: u32,
    wisps: u32,
    strand_points: u32,
}

// Twin of `Wisp` in mod.rs: its guides, and its frame at the root in the rest pose.
struct Wisp {
    guides: vec3u,
    tangent: vec3f,
    normal: vec3f,
}

// The three guides of a wisp at one point, with the normal in their fourth components, and the tangent.
struct CurvePoint {
    a: vec4f,
    b: vec4f,
    c: vec4f,
    tangent: vec4f,
}

@group(0) @binding(0) var<uniform> instant: Instant;
// All x, then all y, then all z.
@group(0) @binding(1) var<storage, read> guides: array<f32>;
@group(0) @binding(2) var<storage, read> wisps: array<Wisp>;
@group(0) @binding(3) var<storage, read_write> curves: array<CurvePoint>;
// The largest radius of the wisp of each guide at each of its points, metres.
@group(0) @binding(8) var<storage, read> widest: array<f32>;

fn guide_point(guide: u32, point: u32) -> vec3f {
    let n = instant.guide_points;
    let i = guide * instant.points_per_guide + point;
    return vec3f(guides[i], guides[n + i], guides[2u * n + i]);
}

fn dot3(a: vec3f, b: vec3f) -> f32 {
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

// The unit vector along `v`, or `otherwise` if `v` has no direction.
fn normalize_or(v: vec3f, otherwise: vec3f) -> vec3f {
    let squared = dot3(v, v);
    // False for NaN.
    if (squared > 0.0 && squared <= 3.4028234e38) {
        return v * (1.0 / sqrt(squared));
    }
    return otherwise;
}

// A unit vector perpendicular to `along`, from the axis that is least parallel to it.
fn reference_normal(along: vec3f) -> vec3f {
    let size = abs(along);
    var axis = vec3f(0.0, 0.0, 1.0);
    if (size.x <= size.y && size.x <= size.z) {
        axis = vec3f(1.0, 0.0, 0.0);
    } else if (size.y <= size.z) {
        axis = vec3f(0.0, 1.0, 0.0);
    }
    return normalize_or(axis - along * dot3(axis, along), vec3f(1.0, 0.0, 0.0));
}

// Rotates a normal by the smallest rotation from one unit vector to another.
fn transport(normal: vec3f, before: vec3f, after: vec3f) -> vec3f {
    let one_plus_cos = 1.0 + dot3(before, after);
    var turned = normal;
    if (one_plus_cos > 1e-6) {
        turned = normal - (before + after) * (dot3(normal, after) / one_plus_cos);
    }
    return normalize_or(turned - after * dot3(turned, after), reference_normal(after));
}

fn to_world(v: vec3f) -> vec3f {
    return (instant.turn_x.xyz * v.x + instant.turn_y.xyz * v.y) + instant.turn_z.xyz * v.z;
}

// The guides of a wisp at point `point`, moved toward their mean if they are further apart than allowed. Twin of `narrowed` in
// lovelock-groom.
fn narrowed_points(w: u32, point: u32) -> array<vec3f, 3> {
    let own = wisps[w].guides;
    var p = array(guide_point(own.x, point), guide_point(own.y, point), guide_point(own.z, point));
    let mean = (p[0] + p[1] + p[2]) / 3.0;
    let away = array(p[0] - mean, p[1] - mean, p[2] - mean);
    let squares = dot3(away[0], away[0]) + dot3(away[1], away[1]) + dot3(away[2], away[2]);
    let radius = sqrt(squares / 3.0);
    let most = widest[own.x * instant.points_per_guide + point];
    // False for NaN.
    if (radius > most) {
        let share = most / radius;
        p[0] = mean + away[0] * share;
        p[1] = mean + away[1] * share;
        p[2] = mean + away[2] * share;
    }
    return p;
}

@compute @workgroup_size(64)
fn carry_frames(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let w = id.x + id.y * groups.x * 64u;
    if (w >= instant.wisps) {
        return;
    }
    let wisp = wisps[w];
    let points = instant.points_per_guide;
    var tangent = to_world(wisp.tangent);
    var normal = to_world(wisp.normal);
    var own = narrowed_points(w, 0u);
    var before = (own[0] + own[1] + own[2]) / 3.0;
    var here = before;
    for (var p = 0u; p < points; p++) {
        // The next point; at the tip, this one.
        let after = min(p + 1u, points - 1u);
        let next_own = narrowed_points(w, after);
        let next = (next_own[0] + next_own[1] + next_own[2]) / 3.0;
        if (p > 0u) {
            let turned_to = normalize_or(next - before, tangent);
            normal = transport(normal, tangent, turned_to);
            tangent = turned_to;
        }
        curves[w * points + p] = CurvePoint(
            vec4f(own[0], normal.x), vec4f(own[1], normal.y), vec4f(own[2], normal.z), vec4f(tangent, 0.0));
        before = here;
        here = next;
        own = next_own;
    }
}
