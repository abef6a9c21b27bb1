// Filtered lookups: four columns per point. Twin of lookup.rs.

@group(0) @binding(3) var<storage, read> map: array<u32>;

// The fractional and the integer part of `c`, clamped to 0 to `end`; the integer part is at most `last`. 0 for NaN.
fn split(c: f32, end: f32, last: u32) -> vec2f {
    let positive = select(0.0, c, c > 0.0);
    let inside = select(end, positive, positive < end);
    let whole = min(u32(inside), last);
    return vec2f(inside - f32(whole), f32(whole));
}

fn mix_of(a: f32, b: f32, t: f32) -> f32 {
    return a + (b - a) * t;
}

fn column_light(cell: vec3u, along: f32) -> f32 {
    let faces = map[cell_at(cell)];
    let front = f32(faces & 0xffffu);
    let back = f32(faces >> 16u);
    if (voxels.reads == AS_PRINTED) {
        return mix_of(exp_of_minus_steps(front), exp_of_minus_steps(back), along);
    }
    // Exact for a cell of uniform density.
    return exp_of_minus_steps(mix_of(front, back, along));
}

// Transmittance at a point.
fn hair_transmittance(world_position: vec3f) -> f32 {
    if (voxels.edge == 0u) {
        return 1.0;
    }
    let p = window_from_world(world_position);
    let n = f32(voxels.edge);
    // The value of a column belongs to its centre; in the printed filter, to its far edge.
    let closest = voxels.reads == CLOSEST;
    let lead = select(select(0.5, 1.0, voxels.reads == AS_PRINTED), 0.0, closest);
    // Points before the window and NaN read the first face and the border, which are lit.
    let u = split(p.x, n, voxels.edge - 1u);
    let v = split(p.y - lead, n - 1.0, voxels.edge - 2u);
    let w = split(p.z - lead, n - 1.0, voxels.edge - 2u);
    let cell = vec3u(u32(u.y), u32(v.y), u32(w.y));
    // The back face of the closest cell alone. Only beyond the last column is a fraction 1.
    let along = select(u.x, 1.0, closest);
    let across = select(vec2f(v.x, w.x), floor(vec2f(v.x, w.x)), closest);
    let near = mix_of(column_light(cell, along), column_light(cell + vec3u(0u, 0u, 1u), along), across.y);
    let far = mix_of(
        column_light(cell + vec3u(0u, 1u, 0u), along),
        column_light(cell + vec3u(0u, 1u, 1u), along),
        across.y,
    );
    return min(mix_of(near, far, across.x), 1.0);
}

fn column_count() -> u32 {
    return voxels.edge;
}

// Transmittance of all hair of a column.
fn behind_column(at: vec2u) -> f32 {
    return exp_of_minus_steps(f32(map[cell_at(vec3u(voxels.edge - 1u, at.y, at.x))] >> 16u));
}
