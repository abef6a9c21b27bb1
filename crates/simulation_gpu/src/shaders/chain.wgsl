// Velocities that stretch no link, positions, and shape memory: one thread per slot.

override CONTACT_PUSH_KEPT: f32;
override NEAR_ROOT: f32;

/// Removes the part of the velocities in the residual that would change the length of a link.
fn project_velocities(slot: u32) {
    let count = step_of.points;
    let first = step_of.first_free;
    var upper = 0.0;
    var rhs = 0.0;
    var off = 0.0;
    var n = link_at(slot, first);
    for (var i = first; i < count; i++) {
        let place = place_of(slot, i);
        let last = i + 1u == count;
        let n_next = link_at(slot, min(i + 1u, count - 1u));
        let between = work3(RESIDUAL, place) - work3(RESIDUAL, place_of(slot, i - 1u));
        let diagonal = select(2.0, 1.0, i == first);
        let pivot = 1.0 / (diagonal - off * upper);
        rhs = (-dot(n, between) - off * rhs) * pivot;
        off = select(-dot(n, n_next), 0.0, last);
        upper = off * pivot;
        put_work1(MULTIPLIER, place, rhs);
        put_work1(UPPER, place, upper);
        put_work3(LINKS, place, n);
        n = n_next;
    }
    var after = 0.0;
    var n_after = vec3f(0.0);
    for (var k = 0u; k + first < count; k++) {
        let place = place_of(slot, count - 1u - k);
        let l = work1(MULTIPLIER, place) - work1(UPPER, place) * after;
        let here = work3(LINKS, place);
        put_work3(RESIDUAL, place, work3(RESIDUAL, place) + here * l - n_after * after);
        after = l;
        n_after = here;
    }
}

/// The direction of the link that ends at point `i`.
fn link_at(slot: u32, i: u32) -> vec3f {
    let place = place_of(slot, i);
    let before = state3(POSITION, place_of(slot, i - 1u));
    return (state3(POSITION, place) - before) * rest1(INV_LENGTH, place);
}

/// Writes the rest bends in the frames carried along the guide, and how far the bends are from them, times the stiffness.
fn bend_residuals(slot: u32) {
    let count = step_of.points;
    let head = head_map();
    var frame_turn = head_turn();
    var expected = rotated(head, rest3(REST_DIRECTION, place_of(slot, 1u)));
    put_work3(RESIDUAL, place_of(slot, 0u), vec3f(0.0));
    put_work3(RESIDUAL, place_of(slot, count - 1u), vec3f(0.0));
    var p0 = work3(NEXT, place_of(slot, 0u));
    var p1 = work3(NEXT, place_of(slot, 1u));
    var x0 = state3(POSITION, place_of(slot, 0u));
    var x1 = state3(POSITION, place_of(slot, 1u));
    for (var i = 1u; i + 1u < count; i++) {
        let place = place_of(slot, i);
        let after = place_of(slot, i + 1u);
        let p2 = work3(NEXT, after);
        let x2 = state3(POSITION, after);
        let link = direction_or(p1 - p0, expected).unit;
        frame_turn = then_smallest(frame_turn, expected, link);
        expected = turned(frame_turn, rest3(REST_DIRECTION, after));
        let with_lock = expected * rest1(REST_LENGTH, after) - link * rest1(REST_LENGTH, place);
        let with_head = rotated(head, rest3(REST_BEND, place));
        let wanted = with_lock + (with_head - with_lock) * matrix1(HEAD_SHARE, place);
        let gamma = matrix1(GAMMA, place);
        let now = p0 - 2.0 * p1 + p2;
        let before = x0 - 2.0 * x1 + x2;
        let r = (now - wanted) * (1.0 + gamma) - (before - state3(BEND, place)) * gamma;
        put_state3(BEND, place, wanted);
        put_work3(RESIDUAL, place, r * matrix1(STIFFNESS, place));
        p0 = p1;
        p1 = p2;
        x0 = x1;
        x1 = x2;
    }
}

/// Pulls the guide toward its rest bends, and toward the style near the root.
fn shape_memory(slot: u32) {
    let count = step_of.points;
    let first = step_of.first_free;
    bend_residuals(slot);
    let head = head_map();
    var one = vec3f(0.0);
    var two = vec3f(0.0);
    var left = work3(RESIDUAL, place_of(slot, first - 1u));
    for (var i = first; i < count; i++) {
        let place = place_of(slot, i);
        let middle = work3(RESIDUAL, place);
        var right = vec3f(0.0);
        if i + 1u < count {
            right = work3(RESIDUAL, place_of(slot, i + 1u));
        }
        let styled = mapped(head, rest3(REST_POSITION, place)) - work3(NEXT, place);
        let force = 2.0 * middle - left - right + styled * matrix1(HOLD, place);
        left = middle;
        let y = eliminated(place, force, one, two);
        put_work3(RESIDUAL, place, y);
        two = one;
        one = y;
    }
    finish(slot, NEXT);
}

/// Moves points in advance by most of the contact displacement of the last substep, together with everything beyond
/// them.
fn apply_contact_push(slot: u32) {
    var moved = vec3f(0.0);
    var moved_before = vec3f(0.0);
    let root = matrix1(HOLD, place_of(slot, clamp(step_of.first_free, 1u, step_of.points - 1u)));
    for (var i = step_of.first_free; i < step_of.points; i++) {
        let place = place_of(slot, i);
        let shift = followed(slot, i - 1u, moved_before, moved);
        moved_before = moved;
        let out = direction_or(state3(CONTACT_PUSH, place), vec3f(0.0));
        // At most as far as the stiffness pulls inward.
        let against = greater(0.0, lesser(out.length, -dot(work3(RESIDUAL, place), out.unit)));
        let near_root = matrix1(HOLD, place) > NEAR_ROOT * root;
        let push = out.unit * (CONTACT_PUSH_KEPT * select(0.0, against, near_root));
        moved = shift + push;
        put_state3(CONTACT_PUSH, place, push);
        put_work3(NEXT, place, work3(NEXT, place) + moved);
    }
}

/// One thread per slot.
@compute @workgroup_size(64)
fn bend(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let slot = id.x + id.y * groups.x * 64u;
    if slot >= slots() {
        return;
    }
    if step_of.integrator == DIRECT && step_of.first_free < step_of.points {
        project_velocities(slot);
    }
    for (var i = 0u; i < step_of.points; i++) {
        let place = place_of(slot, i);
        let v = work3(RESIDUAL, place);
        put_state3(VELOCITY, place, v);
        put_work3(NEXT, place, state3(POSITION, place) + v * step_of.h);
    }
    shape_memory(slot);
    if step_of.integrator == DIRECT {
        apply_contact_push(slot);
    }
}
