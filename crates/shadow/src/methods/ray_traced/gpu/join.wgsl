// Joins the boxes of one level of the tree in pairs.

struct LevelUniform {
    // Nodes of the level that is made, and its first one.
    nodes: u32,
}

@group(0) @binding(7) var<uniform> level: LevelUniform;
@group(0) @binding(5) var<storage, read_write> nodes: array<vec4f>;

@compute @workgroup_size(64)
fn join_boxes(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= level.nodes) {
        return;
    }
    let node = level.nodes + i;
    nodes[2u * node] = min(nodes[4u * node], nodes[4u * node + 2u]);
    nodes[2u * node + 1u] = max(nodes[4u * node + 1u], nodes[4u * node + 3u]);
}
