// The lengths of the links of a guide, from the positions `HELD`: one thread per slot.

override SAME_DIRECTION: f32;
override LEAST_PIVOT: f32;

/// Writes the directions of the links, and how much each is too short.
fn length_errors(slot: u32) {
    var a = work3(HELD, place_of(slot, step_of.first_free - 1u));
    for (var i = step_of.first_free; i < step_of.points; i++) {
        let place = place_of(slot, i);
        let b = work3(HELD, place);
        let wanted = rest1(REST_LENGTH, place);
        let link = b - a;
        let squared = dot(link, link);
        let inv = inv_sqrt(squared);
        // Links of no length lie beyond the end of a guide that was cut, and exert no force.
        let there = wanted > 0.0;
        put_work3(LINKS, place, select(vec3f(0.0), link * inv, there));
        put_work1(MULTIPLIER, place, select(0.0, wanted - squared * inv, there));
        a = b;
    }
}

/// Factorises `S` for the stored directions, column by column. The diagonal of the factor is stored as its inverse.
fn factorise_lengths(slot: u32) {
    let first = step_of.first_free;
    let links = link_count();
    for (var c = 0u; c < links; c++) {
        let n = state3(DIRECTION, place_of(slot, first + c));
        let whole = matrix[entry(0u, slot, c, c)] * dot(n, n);
        var pivot = whole;
        for (var k = 0u; k < c; k++) {
            let l = matrix[entry(1u, slot, c, k)];
            pivot -= l * l;
        }
        let inv = inv_sqrt(greater(pivot, greater(LEAST_PIVOT * whole, 1e-9)));
        matrix[entry(1u, slot, c, c)] = inv;
        for (var r = c + 1u; r < links; r++) {
            let m = state3(DIRECTION, place_of(slot, first + r));
            var sum = matrix[entry(0u, slot, r, c)] * dot(m, n);
            for (var k = 0u; k < c; k++) {
                sum -= matrix[entry(1u, slot, r, k)] * matrix[entry(1u, slot, c, k)];
            }
            matrix[entry(1u, slot, r, c)] = sum * inv;
        }
    }
}

/// Factorises again where a link has turned relative to the head since it was done last.
fn update_factor(slot: u32) {
    let head = head_map();
    var furthest = 0.0;
    var known = true;
    for (var i = step_of.first_free; i < step_of.points; i++) {
        let place = place_of(slot, i);
        let off = rotated_back(head, work3(LINKS, place)) - state3(DIRECTION, place);
        let squared = dot(off, off);
        known = known && is_finite(squared);
        furthest = greater(furthest, squared);
    }
    let is_turned = !known || furthest > SAME_DIRECTION;
    if is_turned {
        for (var i = step_of.first_free; i < step_of.points; i++) {
            let place = place_of(slot, i);
            put_state3(DIRECTION, place, rotated_back(head, work3(LINKS, place)));
        }
    }
    if is_turned || matrix[flag(IS_COMPUTED, slot)] == 0.0 {
        factorise_lengths(slot);
        matrix[flag(IS_COMPUTED, slot)] = 1.0;
    }
}

/// One Newton step of the lengths in the metric of the bends.
fn coupled_lengths(slot: u32) {
    let first = step_of.first_free;
    let count = step_of.points;
    let links = link_count();
    if substep_of.checks_factor != 0u {
        update_factor(slot);
    }
    for (var r = 0u; r < links; r++) {
        let place = place_of(slot, first + r);
        var y = work1(MULTIPLIER, place);
        for (var c = 0u; c < r; c++) {
            y -= matrix[entry(1u, slot, r, c)] * work1(MULTIPLIER, place_of(slot, first + c));
        }
        put_work1(MULTIPLIER, place, y * matrix[entry(1u, slot, r, r)]);
    }
    for (var n = 0u; n < links; n++) {
        let r = links - 1u - n;
        let place = place_of(slot, first + r);
        let y = work1(MULTIPLIER, place) * matrix[entry(1u, slot, r, r)];
        put_work1(MULTIPLIER, place, y);
        for (var c = 0u; c < r; c++) {
            let other = place_of(slot, first + c);
            put_work1(MULTIPLIER, other, work1(MULTIPLIER, other) - matrix[entry(1u, slot, r, c)] * y);
        }
    }
    // Each link pulls its two ends in opposite directions.
    var one = vec3f(0.0);
    var two = vec3f(0.0);
    for (var i = first; i < count; i++) {
        let place = place_of(slot, i);
        var force = work3(LINKS, place) * work1(MULTIPLIER, place);
        if i + 1u < count {
            let after = place_of(slot, i + 1u);
            force -= work3(LINKS, after) * work1(MULTIPLIER, after);
        }
        let y = eliminated(place, force, one, two);
        put_work3(RESIDUAL, place, y);
        two = one;
        one = y;
    }
    finish(slot, HELD);
}

/// One Newton step of the lengths of a guide that nothing bends: Thomas elimination.
fn chain_lengths(slot: u32) {
    let count = step_of.points;
    let first = step_of.first_free;
    var upper = 0.0;
    var rhs = 0.0;
    var off = 0.0;
    for (var i = first; i < count; i++) {
        let place = place_of(slot, i);
        let last = i + 1u == count;
        let diagonal = select(2.0, 1.0, i == first);
        let pivot = 1.0 / (diagonal - off * upper);
        rhs = (work1(MULTIPLIER, place) - off * rhs) * pivot;
        let n_next = work3(LINKS, place_of(slot, min(i + 1u, count - 1u)));
        off = select(-dot(work3(LINKS, place), n_next), 0.0, last);
        upper = off * pivot;
        put_work1(MULTIPLIER, place, rhs);
        put_work1(UPPER, place, upper);
    }
    var after = 0.0;
    var n_after = vec3f(0.0);
    for (var k = 0u; k + first < count; k++) {
        let place = place_of(slot, count - 1u - k);
        let l = work1(MULTIPLIER, place) - work1(UPPER, place) * after;
        let here = work3(LINKS, place);
        put_work3(HELD, place, work3(HELD, place) + here * l - n_after * after);
        after = l;
        n_after = here;
    }
}

/// Displaces the ends of the link that ends at point `i`; the first end only if it is free.
fn restore_link(slot: u32, i: u32) {
    let place = place_of(slot, i);
    let before = place_of(slot, i - 1u);
    let a = work3(HELD, before);
    let b = work3(HELD, place);
    let now = length_of(b - a);
    let by = (b - a) * ((rest1(REST_LENGTH, place) - now) / (now + 1e-20));
    let free = i > step_of.first_free;
    put_work3(HELD, before, a - by * select(0.0, 0.5, free));
    put_work3(HELD, place, b + by * select(1.0, 0.5, free));
}

/// Relaxation of one link after the other.
fn relax(slot: u32) {
    for (var n = 0u; n < step_of.sweeps; n++) {
        for (var k = step_of.first_free; k < step_of.points; k++) {
            restore_link(slot, select(step_of.points - 1u + step_of.first_free - k, k, n % 2u == 0u));
        }
    }
}

/// One thread per slot.
@compute @workgroup_size(64)
fn lengths(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let slot = id.x + id.y * groups.x * 64u;
    if slot >= slots() || step_of.first_free >= step_of.points {
        return;
    }
    if step_of.integrator == RELAXATION {
        relax(slot);
    } else if step_of.integrator == DIRECT {
        length_errors(slot);
        if matrix[flag(IS_CHAIN, slot)] != 0.0 {
            chain_lengths(slot);
        } else {
            coupled_lengths(slot);
        }
    }
}
