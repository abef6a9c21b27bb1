// Makes the curve of a texel: each step adds two nodes, and the node whose loss changes the area least goes. Twin of cpu.rs.

// Twice the area between the curve and that without node `at`.
fn loss(at: u32) -> f32 {
    let before = (depths[at] - depths[at - 1u]) * (lights[at + 1u] - lights[at - 1u]);
    let all = (depths[at + 1u] - depths[at - 1u]) * (lights[at] - lights[at - 1u]);
    return abs(all - before);
}

// Adds a node behind `count` others. Returns how many there are.
fn add(count: u32, depth: f32, light: f32) -> u32 {
    depths[count] = depth;
    lights[count] = light;
    if (count < NODES) {
        return count + 1u;
    }
    var least = 3.4e38;
    var lost = 1u;
    // Two at once: Mesa's llvmpipe ends the loops of a shader after 65,535 iterations in all.
    for (var at = 1u; at < NODES; at += 2u) {
        let first = loss(at);
        if (first < least) {
            least = first;
            lost = at;
        }
        let second = loss(min(at + 1u, NODES - 1u));
        if (second < least) {
            least = second;
            lost = at + 1u;
        }
    }
    for (var at = lost; at < NODES; at += 2u) {
        depths[at] = depths[at + 1u];
        lights[at] = lights[at + 1u];
        depths[at + 1u] = depths[at + 2u];
        lights[at + 1u] = lights[at + 2u];
    }
    return NODES;
}

fn texel_pass(texel: u32) {
    let steps = steps_of(texel);
    var count = 0u;
    var before = 1.0;
    for (var at = 0u; at < steps.count; at++) {
        let next = step_at(steps, at);
        count = add(count, next.x, before);
        count = add(count, next.x, next.y);
        before = next.y;
    }
    write_curve(texel, count);
}
