// The forces of a step, computed once and applied in every substep.

override SUPPORT_FULL: f32;
override SUPPORT_NONE: f32;
override FAST_AIR: f32;

/// One thread per point and slot.
@compute @workgroup_size(64)
fn prepare(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let place = id.x + id.y * groups.x * 64u;
    if place >= numbers() {
        return;
    }
    let slot = slot_of(place);
    let i = point_of(place);
    let head = map_at(LAST_HEAD);
    let here = state3(POSITION, place);
    let velocity = state3(VELOCITY, place);
    // The support of the style, faded with the distance from the place at rest; see `faded_support`.
    let support = rotated(head, rest3(REST_SUPPORT, place));
    let away = direction_or(here - mapped(head, rest3(REST_POSITION, place)), vec3f(0.0));
    let length = of_slot(MEAN_LINK, slot) * f32(i) + 1e-6;
    let inv_range = 1.0 / ((SUPPORT_NONE - SUPPORT_FULL) * length);
    let t = lesser(greater((SUPPORT_NONE * length - away.length) * inv_range, 0.0), 1.0);
    let w = t * t * (3.0 - 2.0 * t);
    let slope = -6.0 * t * (1.0 - t) * inv_range;
    let faded = support * w + away.unit * (dot(support, away.unit * away.length) * slope);
    var push = (vec3f(0.0, -step_of.gravity, 0.0) + faded * step_of.support) * step_of.h;
    // The effect of the grid, between the samples around the point.
    let last = step_of.points - 1u;
    let sample = min(i / step_of.stride, step_of.samples - 2u);
    let low = sampled_point(sample);
    let high = sampled_point(sample + 1u);
    let along = f32(i - low) / f32(high - low);
    let a = place_of(slot, low);
    let b = place_of(slot, high);
    let inside = blend(work1(GRID_INSIDE, a), work1(GRID_INSIDE, b), along);
    let mean = mix(work3(GRID_MEAN, a), work3(GRID_MEAN, b), along);
    let relative = mean - velocity;
    let substeps = f32(step_of.substeps);
    let friction = row_rate(i, ROW_HAIR_FRICTION) * substeps * inside;
    let taken = 1.0 - (1.0 - step_of.cohesion) * (1.0 - rubbed(friction, relative));
    push += mix(work3(GRID_PUSH, a), work3(GRID_PUSH, b), along) + relative * (taken / substeps);
    let position = here + step_of.rebase;
    push += rope_friction(slot, place, velocity) / substeps;
    var wind = vec3f(0.0);
    if step_of.windy != 0u {
        wind = wind_at(position) * exposure(position);
    }
    let speed = length_of(wind - velocity);
    let drag = row_rate(i, ROW_DRAG) * (1.0 + speed * (1.0 / FAST_AIR));
    let keep = 1.0 / (1.0 + drag * (1.0 - step_of.air_shelter * inside));
    put_state3(POSITION, place, position);
    put_work3(START_POSE, place, position);
    put_work3(PUSH, place, push * keep + wind * (1.0 - keep));
    put_work1(KEEP, place, keep);
    put_work1(CARRIED, place, w * inside);
}
