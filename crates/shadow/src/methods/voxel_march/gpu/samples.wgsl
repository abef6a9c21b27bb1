// The samples of strands. A pass defines `add_sample`. Twin of bricks.rs.

@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(2) var<storage, read> segments: array<u32>;

// Whether hair at a place of the window casts a shadow. False for NaN.
fn holds(p: vec3f) -> bool {
    let size = vec3f(march.bricks * BRICK);
    return all(p >= vec3f(1.0)) && all(p <= size - 1.0);
}

@compute @workgroup_size(64)
fn each_segment(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= march.segments) {
        return;
    }
    let first = segments[i];
    let start = window_from_world(points[first].xyz);
    let end = window_from_world(points[first + 1u].xyz);
    if (!holds(start) || !holds(end)) {
        return;
    }
    let d = end - start;
    let length_in_cells = sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    // Neighbouring samples are at most half a cell apart.
    let count = u32(2.0 * length_in_cells) + 1u;
    let inverse = 1.0 / f32(count);
    let depth = u32(min(march.each * length_in_cells * inverse + 0.5, f32(MOST)));
    if (depth == 0u) {
        return;
    }
    for (var sample_index = 0u; sample_index < count; sample_index++) {
        let t = min((f32(sample_index) + 0.5) * inverse, 1.0);
        let cell = vec3u(start + d * t);
        let own = cell / BRICK;
        let within = cell % BRICK;
        // Its own brick, and those at whose end it lies.
        for (var which = 0u; which < 8u; which++) {
            let before = vec3u(which & 1u, (which >> 1u) & 1u, which >> 2u);
            if (all((before == vec3u(0u)) | (within == vec3u(0u))) && all(own >= before)) {
                let at = within + before * BRICK;
                add_sample(brick_at(own - before), at.x + STORED * (at.y + STORED * at.z), depth);
            }
        }
    }
}
