// Puts segments in the order of their keys, and makes the boxes of leaves.

@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(2) var<storage, read> segments: array<u32>;
@group(0) @binding(3) var<storage, read> keys: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> ends: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> nodes: array<vec4f>;

@compute @workgroup_size(64)
fn make_leaves(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let leaf = id.x + id.y * groups.x * 64u;
    let leaves = trace.places / LEAF;
    if (leaf >= leaves) {
        return;
    }
    // Above and below everything: the box of nothing.
    var low = vec3f(1e30);
    var high = vec3f(-1e30);
    for (var i = leaf * LEAF; i < (leaf + 1u) * LEAF; i++) {
        let number = keys[i].y;
        var a = vec4f(0.0);
        var b = vec4f(0.0);
        if (number != NONE) {
            a = vec4f(points[segments[number]].xyz - trace.anchor, 1.0);
            b = vec4f(points[segments[number] + 1u].xyz - trace.anchor, 1.0);
            low = min(low, min(a.xyz, b.xyz) - trace.half_width);
            high = max(high, max(a.xyz, b.xyz) + trace.half_width);
        }
        ends[2u * i] = a;
        ends[2u * i + 1u] = b;
    }
    nodes[2u * (leaves + leaf)] = vec4f(low, 0.0);
    nodes[2u * (leaves + leaf) + 1u] = vec4f(high, 0.0);
}
