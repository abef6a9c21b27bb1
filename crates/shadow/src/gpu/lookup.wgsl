// Looks up many points in the map of one light. A method's query defines `hair_transmittance`, and `PROJECTED`: whether points are
// projected before they are looked up.

struct Lookup {
    // Points, items from one point to the next, slot of the light, 1 if the sum is wanted.
    count: u32,
    stride: u32,
    slot: u32,
    sums: u32,
    // Of a light that stands somewhere: a point near the hair, and the number of its planes.
    anchor: vec3f,
    sides: u32,
    // Its axes, and the plane whose points are looked up.
    axis: vec3f,
    side: u32,
    // Bits of the planes without hair, whose points are lit.
    across: vec3f,
    lit: u32,
    // Distance of the plane, metres.
    more: vec3f,
    plane: f32,
    // The anchor, seen from the light along the axes.
    offset: vec3f,
}

const SUM_WORDS: u32 = 256u;

@group(0) @binding(10) var<uniform> lookup: Lookup;
@group(0) @binding(11) var<storage, read> targets: array<vec4f>;
@group(0) @binding(12) var<storage, read_write> answers: array<u32>;
@group(0) @binding(13) var<storage, read_write> sum: array<atomic<u32>>;

// Coordinates on a side of a cube, the first one outward. Twin of `turned` in perspective/cube.rs.
fn turned(v: vec3f, side: u32) -> vec3f {
    let axis = side >> 1u;
    let cycled = select(select(v.zxy, v.yzx, axis == 1u), v, axis == 0u);
    return select(cycled, vec3f(-cycled.x, cycled.z, cycled.y), (side & 1u) != 0u);
}

// The transmittance at a point for a light that stands somewhere; negative if the point belongs to another plane. Twin of
// `Face::project`.
fn standing_transmittance(p: vec3f) -> f32 {
    let d = p - lookup.anchor;
    let from_anchor = vec3f(dot(lookup.axis, d), dot(lookup.across, d), dot(lookup.more, d));
    let q = lookup.offset + from_anchor;
    let side = select(0u, side_of(q), lookup.sides > 1u);
    if (side != lookup.side) {
        return select(-1.0, 1.0, ((lookup.lit >> side) & 1u) != 0u);
    }
    let sum = length(q) + length(lookup.offset);
    let depth = select(0.0, dot(from_anchor, q + lookup.offset) / sum, sum > 0.0);
    let on_side = turned(q, side);
    // Everything behind the light is lit.
    if (!(on_side.x > 0.0)) {
        return 1.0;
    }
    return hair_transmittance(vec3f(depth, on_side.yz * (lookup.plane / on_side.x)));
}

@compute @workgroup_size(64)
fn look_up_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= lookup.count) {
        return;
    }
    let p = targets[i * lookup.stride].xyz;
    var t: f32;
    if (PROJECTED) {
        t = standing_transmittance(p);
        if (t < 0.0) {
            return;
        }
    } else {
        t = hair_transmittance(p);
    }
    let byte = u32(clamp(t, 0.0, 1.0) * 255.0 + 0.5);
    if (lookup.slot == 0u) {
        answers[i] = 0xffffff00u | byte;
    } else {
        let shift = 8u * lookup.slot;
        answers[i] = (answers[i] & ~(0xffu << shift)) | (byte << shift);
    }
    if (lookup.sums != 0u) {
        // Spread over many words to reduce contention.
        atomicAdd(&sum[(i >> 6u) % SUM_WORDS], byte);
    }
}
