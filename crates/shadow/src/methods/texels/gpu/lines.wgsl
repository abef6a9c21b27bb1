// Rasterises segments in steps along the longer axis, for which thin_step.wgsl or filtered_step.wgsl defines `put_step`.
// Twin of lines.rs. A pass defines `put(texel, depth, weight)`.

@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(2) var<storage, read> segments: array<u32>;

// Whether a point was included in the bounds of the window. False for NaN.
fn holds(p: vec3f) -> bool {
    let far = 2.0 * f32(texels.edge);
    return abs(p.x) <= far && abs(p.y) <= far && abs(p.z) <= 2.0;
}

// Clamped to the window: rounding must not move hair into the empty texels at the border.
fn held(p: vec3f) -> vec3f {
    let highest = f32(texels.edge - 1u) * (1.0 - 1.1920929e-7);
    return clamp(p, vec3f(1.0, 1.0, 0.0), vec3f(highest, highest, 1.0));
}

// The number of texel centres below `c`, which is not negative.
fn centres_below(c: f32) -> i32 {
    let whole = i32(c);
    return whole + select(0, 1, c - f32(whole) > 0.5);
}

// The texel at these coordinates on the longer and the shorter axis; texels at the border stay empty.
fn texel_of(by_row: bool, major: i32, minor: i32) -> u32 {
    let held_minor = u32(clamp(minor, 1, i32(texels.edge) - 2));
    let at = select(vec2u(u32(major), held_minor), vec2u(held_minor, u32(major)), by_row);
    return at.y * texels.edge + at.x;
}

@compute @workgroup_size(64)
fn draw(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= texels.segments) {
        return;
    }
    let first = segments[i];
    let from_free = texel_from_world(points[first].xyz);
    let to_free = texel_from_world(points[first + 1u].xyz);
    if (!holds(from_free) || !holds(to_free)) {
        return;
    }
    let a = held(from_free);
    let b = held(to_free);
    let d = b - a;
    let by_row = abs(d.y) > abs(d.x);
    let turned_a = select(a, a.yxz, by_row);
    let turned_b = select(b, b.yxz, by_row);
    let forward = turned_a.x <= turned_b.x;
    let low = select(turned_b, turned_a, forward);
    let high = select(turned_a, turned_b, forward);
    let per_texel = 1.0 / (high.x - low.x);
    let end = centres_below(high.x);
    let length = sqrt(d.x * d.x + d.y * d.y) * per_texel;
    let rise = high - low;
    for (var major = centres_below(low.x); major < end; major++) {
        let t = (f32(major) + 0.5 - low.x) * per_texel;
        if (PROJECTED) {
            let part = select(1.0 - t, t, forward);
            let ray = on_ray(points[first], points[first + 1u], part, texels.plane, texels.start);
            let along = texel_from_world(vec3f(ray.x, 0.0, 0.0)).z;
            put_step(by_row, major, low.y + t * rise.y, clamp(along, 0.0, 1.0), length, ray.y);
        } else {
            let depth = clamp(low.z + t * rise.z, 0.0, 1.0);
            put_step(by_row, major, low.y + t * rise.y, depth, length, 1.0);
        }
    }
}
