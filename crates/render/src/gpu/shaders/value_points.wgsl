// Replaces the colours of shaded points by a value and the share with which it counts: transmittance for layers.wgsl, given values for
// false_colors.wgsl.

// Numbers, one per point.
@group(0) @binding(19) var<storage, read> values: array<f32>;
// The number that becomes 0, and the reciprocal of the distance to the number that becomes 1.
@group(0) @binding(20) var<uniform> value_range: vec2f;

// Values from this limit on are missing. Twin of `MAX` in cpu/values/mod.rs.
const MAX_VALUE: f32 = 1e30;
// The most that a fragment can hold as a half float, with room for the gain of streaks.
const MAX_PLACE: f32 = 5e4;

fn put_value(i: u32, value: f32, share: f32) {
    // The hash of the strand is kept.
    let hash = shaded[i].color.y & 0xffff0000u;
    shaded[i].color = vec2u(pack2x16float(vec2f(value, share)), hash);
}

// The transmittance of the first light.
@compute @workgroup_size(64)
fn value_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i < drawn_points()) {
        put_value(i, select(1.0, unpack4x8unorm(light_left[i]).x, frame.light_count > 0u), 1.0);
    }
}

// The places of given values in their range.
@compute @workgroup_size(64)
fn given_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i < arrayLength(&values)) {
        let value = values[i];
        let place = clamp((value - value_range.x) * value_range.y, -MAX_PLACE, MAX_PLACE);
        let known = abs(value) < MAX_VALUE;
        put_value(i, select(0.0, place, known), select(0.0, 1.0, known));
    }
}
