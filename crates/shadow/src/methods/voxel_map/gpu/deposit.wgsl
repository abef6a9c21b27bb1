// Every sample of a strand adds its optical depth to the cell that contains it. Twin of deposit.rs and samples.rs.

@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(2) var<storage, read> segments: array<u32>;
@group(0) @binding(3) var<storage, read_write> map: array<atomic<u32>>;
// One bit per cell: set if its sum has wrapped around.
@group(0) @binding(4) var<storage, read_write> full: array<atomic<u32>>;

// The most that one sample adds, in fixed point: an optical depth of 32.
const MAX_PER_SAMPLE: f32 = 33554432.0;

// Whether a point was included in the bounds of the window. False for NaN.
fn holds(p: vec3f) -> bool {
    let far = 2.0 * f32(voxels.edge);
    return abs(p.x) <= far && abs(p.y) <= far && abs(p.z) <= far;
}

// Clamped to the window: rounding must not move hair into the empty cells at the border.
fn held(p: vec3f) -> vec3f {
    let highest = f32(voxels.edge - 1u) * (1.0 - 1.1920929e-7);
    return clamp(p, vec3f(1.0), vec3f(highest));
}

fn add(cell: vec3u, depth: u32) {
    let at = cell_at(cell);
    let before = atomicAdd(&map[at], depth);
    // However many threads add at once, exactly one of them sees the sum wrap around.
    if (before + depth < before) {
        atomicOr(&full[at >> 5u], 1u << (at & 31u));
    }
}

@compute @workgroup_size(64)
fn deposit_segments(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= voxels.segments) {
        return;
    }
    let first = segments[i];
    let from_free = window_from_world(points[first].xyz);
    let to_free = window_from_world(points[first + 1u].xyz);
    if (!holds(from_free) || !holds(to_free)) {
        return;
    }
    let start = held(from_free);
    let d = held(to_free) - start;
    let across = d.y * d.y + d.z * d.z;
    // Neighbouring samples are at most half a cell apart.
    let count = u32(2.0 * sqrt(d.x * d.x + across)) + 1u;
    let inverse = 1.0 / f32(count);
    // The length across the light, in cells, counts.
    let counted = vec2f(d.x * d.x, across) * voxels.squares;
    if (PROJECTED) {
        for (var sample_index = 0u; sample_index < count; sample_index++) {
            let t = min((f32(sample_index) + 0.5) * inverse, 1.0);
            let ray = on_ray(points[first], points[first + 1u], t, voxels.plane, voxels.start);
            let along = window_from_world(vec3f(ray.x, 0.0, 0.0)).x;
            let p = held(vec3f(along, (start + d * t).yz));
            // Lengths on the plane are as much longer as widths; lengths along the light are not.
            let each = voxels.deposit * sqrt(counted.x * (ray.y * ray.y) + counted.y) * inverse;
            add(vec3u(p), u32(min(each * ray.y + 0.5, MAX_PER_SAMPLE)));
        }
        return;
    }
    let depth = u32(min(voxels.deposit * sqrt(counted.x + counted.y) * inverse + 0.5, MAX_PER_SAMPLE));
    if (depth == 0u) {
        return;
    }
    for (var sample_index = 0u; sample_index < count; sample_index++) {
        let t = min((f32(sample_index) + 0.5) * inverse, 1.0);
        add(vec3u(start + d * t), depth);
    }
}

@compute @workgroup_size(64)
fn deposit_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= voxels.points) {
        return;
    }
    let p = window_from_world(points[i].xyz);
    if (holds(p)) {
        var depth = voxels.deposit;
        if (PROJECTED) {
            depth *= min(points[i].w, MAX_WIDENING * MAX_WIDENING);
        }
        add(vec3u(held(p)), u32(min(depth + 0.5, MAX_PER_SAMPLE)));
    }
}
