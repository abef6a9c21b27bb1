// The place of each segment on a curve that fills space (Morton 1966). Twin of hierarchy.rs.

@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(2) var<storage, read> segments: array<u32>;
@group(0) @binding(3) var<storage, read_write> keys: array<vec2u>;

// Puts two bits of 0 between all of ten bits.
fn spread(bits: vec3u) -> vec3u {
    var v = bits;
    v = (v | (v << vec3u(16u))) & vec3u(0x030000ffu);
    v = (v | (v << vec3u(8u))) & vec3u(0x0300f00fu);
    v = (v | (v << vec3u(4u))) & vec3u(0x030c30c3u);
    return (v | (v << vec3u(2u))) & vec3u(0x09249249u);
}

// False for NaN.
fn is_seen(p: vec3f) -> bool {
    return abs(p.x) <= FARTHEST && abs(p.y) <= FARTHEST && abs(p.z) <= FARTHEST;
}

@compute @workgroup_size(64)
fn make_keys(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= trace.places) {
        return;
    }
    var key = vec2u(NONE);
    if (i < trace.segments) {
        let a = points[segments[i]].xyz - trace.anchor;
        let b = points[segments[i] + 1u].xyz - trace.anchor;
        if (is_seen(a) && is_seen(b) && any(a != b)) {
            let size = max(trace.high - trace.low, vec3f(1e-12));
            let place = clamp((0.5 * (a + b) - trace.low) / size * 1024.0, vec3f(0.0), vec3f(1023.0));
            let v = spread(vec3u(place));
            key = vec2u(v.x | (v.y << 1u) | (v.z << 2u), i);
        }
    }
    keys[i] = key;
}
