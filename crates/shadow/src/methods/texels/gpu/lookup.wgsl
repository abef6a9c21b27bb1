// Filtered lookups: transmittance of the texel that contains a point, or the bilinear mean of the four around it. Twin of
// lookup.rs. A method's query defines `depth_before(texel, depth)`.

@group(0) @binding(3) var<storage, read> map: array<u32>;

// The filter: the texel that contains the point (0), the mean of the four around it (1), or the texel of a jittered position (2).
override FILTER: u32 = 1u;

// A depth behind all hair.
const BEHIND: f32 = 2.0;

fn texel_light(column: i32, row: i32, depth: f32) -> f32 {
    let n = i32(texels.edge);
    let at = clamp(vec2i(column, row), vec2i(0), vec2i(n - 1));
    let light = exp_of_minus(depth_before(u32(at.y * n + at.x), depth));
    return select(1.0, light, all(at == vec2i(column, row)));
}

// A hash of a position, the same on every device unless rounding moves it across a border of the grid of an eighth of a
// millimetre: PCG in three dimensions (Jarzynski, Olano 2020, "Hash Functions for GPU Rendering").
fn place_hash(p: vec3f) -> vec2f {
    var v = bitcast<vec3u>(vec3i(floor(p * 8192.0))) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3u(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return vec2f(v.xy >> vec2u(8u)) * (1.0 / 16777216.0);
}

// Transmittance at a position in the map.
fn light_at(p: vec3f, world_position: vec3f) -> f32 {
    let depth = min(p.z, BEHIND);
    if (FILTER != 1u) {
        var at = p.xy;
        if (FILTER == 2u) {
            at += place_hash(world_position) - 0.5;
        }
        let texel = vec2i(floor(at));
        return texel_light(texel.x, texel.y, depth);
    }
    let at = p.xy - 0.5;
    let low = floor(at);
    let part = at - low;
    let texel = vec2i(low);
    let a = texel_light(texel.x, texel.y, depth);
    let b = texel_light(texel.x + 1, texel.y, depth);
    let c = texel_light(texel.x, texel.y + 1, depth);
    let d = texel_light(texel.x + 1, texel.y + 1, depth);
    let near = a + (b - a) * part.x;
    let far = c + (d - c) * part.x;
    return min(near + (far - near) * part.y, 1.0);
}

// Transmittance at a point.
fn hair_transmittance(world_position: vec3f) -> f32 {
    let p = texel_from_world(world_position);
    let end = f32(texels.edge) + 1.0;
    // False for NaN. Points before all hair are lit.
    let inside = p.x > -1.0 && p.x < end && p.y > -1.0 && p.y < end && p.z > 0.0;
    // Evaluated for every point: on software adapters a branch would not be faster.
    return select(1.0, light_at(select(vec3f(0.0), p, inside), world_position), inside);
}

fn column_count() -> u32 {
    return texels.edge;
}

// Transmittance of all hair of a texel.
fn behind_column(at: vec2u) -> f32 {
    return texel_light(i32(at.x), i32(at.y), BEHIND);
}
