// Forces on velocities, and the three guides of a wisp as one lock.

override LOCK_FREE: f32;
override LOCK_LEAST_RADIUS: f32;
override LOCK_FAST: f32;
override LOCK_LOST: f32;
override LOCK_FASTEST: f32;

/// The place of guide `k` of the lock that `place` belongs to.
fn in_lock(place: u32, k: u32) -> u32 {
    let slot = place % SLOTS;
    return place - slot + slot / 3u * 3u + k;
}

/// Whether three points are within `most` of their middle.
fn all_within(a: vec3f, b: vec3f, c: vec3f, middle: vec3f, most: f32) -> bool {
    let x = a - middle;
    let y = b - middle;
    let z = c - middle;
    let mean = (dot(x, x) + dot(y, y) + dot(z, z)) * (1.0 / 3.0);
    return is_finite(mean) && mean < most * most * (1.0 / 3.0);
}

/// The velocity of a free point after the forces, without its lock.
fn forced(place: u32) -> vec3f {
    let slot = slot_of(place);
    let i = point_of(place);
    let was = state3(VELOCITY, place);
    let relative = mapped(rigid_map(), state3(POSITION, place)) - was;
    let factor = rest1(DAMPING_FACTOR, place);
    let settle = select(1.0 - exp(-step_of.settle_rate * factor * step_of.h), step_of.settle, factor == 1.0);
    let friction = rubbed(row_rate(i, ROW_HAIR_FRICTION) * work1(CARRIED, place), relative);
    let settled = was + relative * greater(settle, friction);
    return settled * work1(KEEP, place) + work3(PUSH, place);
}

/// One thread per point and slot: the velocities, into the residual.
@compute @workgroup_size(64)
fn forces(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let place = id.x + id.y * groups.x * 64u;
    if place >= numbers() {
        return;
    }
    let i = point_of(place);
    if i < step_of.first_free {
        let to = mapped(head_map(), rest3(REST_POSITION, place));
        put_work3(RESIDUAL, place, (to - state3(POSITION, place)) * (1.0 / step_of.h));
        return;
    }
    var v = forced(place);
    if of_slot(IS_IN_LOCK, slot_of(place)) != 0.0 {
        let a = forced(in_lock(place, 0u));
        let b = forced(in_lock(place, 1u));
        let c = forced(in_lock(place, 2u));
        let mean = (a + b + c) * (1.0 / 3.0);
        let rubs = all_within(a, b, c, mean, LOCK_FASTEST);
        v += select(vec3f(0.0), (mean - v) * row_rate(i, ROW_LOCK_FRICTION), rubs);
    }
    put_work3(RESIDUAL, place, v);
}

/// How far a guide at `p` is pulled toward the middle of its lock.
fn pull(p: vec3f, middle: vec3f, speed_squared: f32, place: u32, share: f32) -> vec3f {
    let fast = lesser(speed_squared * (1.0 / (LOCK_FAST * LOCK_FAST)), 1.0);
    let radius = greater(LOCK_FREE * rest1(LOCK_RADIUS, place), LOCK_LEAST_RADIUS);
    let bound = radius * (1.0 + step_of.opening * fast);
    let off = direction_or(p - middle, vec3f(0.0));
    return select(vec3f(0.0), off.unit * ((bound - off.length) * share), off.length > bound);
}

/// One thread per point and slot: locks and ropes pull their guides back, from `NEXT` to `HELD`.
@compute @workgroup_size(64)
fn hold_together(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let place = id.x + id.y * groups.x * 64u;
    if place >= numbers() {
        return;
    }
    let i = point_of(place);
    let slot = slot_of(place);
    var p = work3(NEXT, place);
    if i >= step_of.first_free {
        if of_slot(IS_IN_LOCK, slot) != 0.0 {
            let places = vec3u(in_lock(place, 0u), in_lock(place, 1u), in_lock(place, 2u));
            let a = work3(NEXT, places.x);
            let b = work3(NEXT, places.y);
            let c = work3(NEXT, places.z);
            let middle = (a + b + c) * (1.0 / 3.0);
            if all_within(a, b, c, middle, LOCK_LOST) {
                let v = state3(VELOCITY, places.x) + state3(VELOCITY, places.y) + state3(VELOCITY, places.z);
                let relative = v * (1.0 / 3.0) - mapped(rigid_map(), middle);
                let squared = dot(relative, relative);
                let share = row_rate(i, ROW_COHESION);
                let of_a = pull(a, middle, squared, places.x, share);
                let of_b = pull(b, middle, squared, places.y, share);
                let of_c = pull(c, middle, squared, places.z, share);
                p += pull(p, middle, squared, place, share) - (of_a + of_b + of_c) * (1.0 / 3.0);
            }
        }
        p = held_in_rope(slot, place, p, f32(substep_of.index + 1u) * step_of.h);
    }
    put_work3(HELD, place, p);
}
