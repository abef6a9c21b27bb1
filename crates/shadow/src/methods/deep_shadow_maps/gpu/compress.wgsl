// Greedy compression of the curve of a texel. Twin of compress.rs.

const STEEPEST: f32 = 3.4e38;

// Nodes, including those that have no room.
var<private> count: u32;
// The largest error of a step.
var<private> tolerance: f32;
// The last step that the line from the last node passes within the tolerance.
var<private> reached: f32;
// The least and the largest slope with which it does.
var<private> slopes: vec2f;

// The last node: depth, light.
fn origin() -> vec2f {
    let last = clamp(count, 1u, MAX_NODES) - 1u;
    return vec2f(depths[last], lights[last]);
}

// Adds a node, from which a new line starts.
fn begin(depth: f32, light: f32) {
    if (count < NODES) {
        depths[count] = depth;
        lights[count] = light;
    }
    count++;
    reached = depth;
    slopes = vec2f(-STEEPEST, STEEPEST);
}

// The light at `depth` of the line whose slope is in the middle. It does not rise.
fn line_at(depth: f32) -> f32 {
    let start = origin();
    return start.y + min(0.5 * slopes.x + 0.5 * slopes.y, 0.0) * (depth - start.x);
}

// The slopes left of a line that passes a place within the tolerance, below `high` and above `low`.
fn slopes_past(depth: f32, high: f32, low: f32) -> vec2f {
    let start = origin();
    let per_depth = 1.0 / (depth - start.x);
    // In this order, light that stays the same has slopes of the same size up and down.
    let least = min(((high - start.y) - tolerance) * per_depth, 0.0);
    let most = ((low - start.y) + tolerance) * per_depth;
    return vec2f(max(slopes.x, least), min(slopes.y, most));
}

// Takes the step from `before` to `behind` at `depth`.
fn take_step(depth: f32, before: f32, behind: f32) {
    if (depth > origin().x) {
        var both = slopes_past(depth, before, behind);
        if (both.x <= both.y) {
            slopes = both;
            reached = depth;
            return;
        }
        // To the step, if its near end can be reached.
        let near = slopes_past(depth, before, before);
        if (near.x > near.y && reached > origin().x) {
            begin(reached, line_at(reached));
            if (count > NODES) {
                return;
            }
            both = slopes_past(depth, before, behind);
            if (both.x <= both.y) {
                slopes = both;
                reached = depth;
                return;
            }
        }
        slopes = slopes_past(depth, before, before);
        let near_light = line_at(depth);
        begin(depth, near_light);
        if (behind < near_light) {
            begin(depth, behind);
        }
        return;
    }
    if (origin().y - behind > tolerance) {
        begin(depth, behind);
    }
}

fn texel_pass(texel: u32) {
    let steps = steps_of(texel);
    if (steps.count == 0u) {
        write_curve(texel, 0u);
        return;
    }
    // From a tolerance of 1 on, one line is enough.
    for (tolerance = texels.tolerance; ; tolerance *= 2.0) {
        count = 0u;
        var before = 1.0;
        begin(step_at(steps, 0u).x, 1.0);
        for (var at = 0u; at < steps.count && count <= NODES; at++) {
            let next = step_at(steps, at);
            take_step(next.x, before, next.y);
            before = next.y;
        }
        if (reached > origin().x) {
            begin(reached, line_at(reached));
        }
        if (count <= NODES || tolerance > 1.0) {
            break;
        }
    }
    write_curve(texel, min(count, NODES));
}
