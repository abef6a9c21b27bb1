// The steps of the curve of a texel, from its sorted list of fragments, which hold running sums.

// Of a texel: where its list starts, its fragments, and how many of them are one step.
struct Steps {
    first: u32,
    fragments: u32,
    stride: u32,
    count: u32,
}

fn steps_of(texel: u32) -> Steps {
    let end = min(atomicLoad(&map[texel * 2u + 1u]), list_room());
    let start = min(atomicLoad(&map[texel * 2u]), end);
    let fragments = end - start;
    let stride = max((fragments + MAX_STEPS - 1u) / MAX_STEPS, 1u);
    return Steps(LIST_HEAD + start, fragments, stride, (fragments + stride - 1u) / stride);
}

// The depth of a step, and the transmittance behind it.
fn step_at(steps: Steps, at: u32) -> vec2f {
    let first = at * steps.stride;
    let last = min(first + steps.stride, steps.fragments) - 1u;
    let sum = list[steps.first + last].y;
    return vec2f(bitcast<f32>(list[steps.first + first].x), exp_of_minus(depth_of_weight(f32(sum))));
}

// The nodes of the curve that is being made.
var<private> depths: array<f32, 36>;
var<private> lights: array<f32, 36>;

fn write_curve(texel: u32, count: u32) {
    let curve = curve_of(texel);
    for (var k = 0u; k < count; k++) {
        atomicStore(&map[curve + k], bitcast<u32>(depths[k]));
        atomicStore(&map[curve + NODES + k], bitcast<u32>(lights[k]));
    }
    atomicStore(&map[texel * 2u], count);
    atomicStore(&map[texel * 2u + 1u], 0u);
}
