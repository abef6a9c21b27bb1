// The factorised matrix of bends, `1 + hold + D2^T c (1 + gamma) D2`, of each guide; see `bending.rs`.

override STIFFEST: f32;
override HALF_SHARPNESS: f32;
override REFERENCE_LENGTH: f32;
override CANTILEVER: f32;

/// Forward elimination of the force at point `i`; `one` and `two` are the results for the two points before.
fn eliminated(place: u32, force: vec3f, one: vec3f, two: vec3f) -> vec3f {
    return force - two * matrix1(BELOW2, place) - one * matrix1(BELOW, place);
}

/// Back substitution at point `i` of `slot`; `one` and `two` are the displacements of the next two points.
fn substituted(slot: u32, i: u32, left: vec3f, one: vec3f, two: vec3f) -> vec3f {
    var v = left * matrix1(INV_PIVOT, place_of(slot, i));
    if i + 2u < step_of.points {
        v -= two * matrix1(BELOW2, place_of(slot, i + 2u));
    }
    if i + 1u < step_of.points {
        v -= one * matrix1(BELOW, place_of(slot, i + 1u));
    }
    return v;
}

/// Back substitution of the residual; adds the displacements to the points of `list`.
fn finish(slot: u32, list: u32) {
    let count = step_of.points;
    var one = vec3f(0.0);
    var two = vec3f(0.0);
    for (var n = 0u; n + step_of.first_free < count; n++) {
        let i = count - 1u - n;
        let place = place_of(slot, i);
        let y = substituted(slot, i, work3(RESIDUAL, place), one, two);
        put_work3(RESIDUAL, place, y);
        put_work3(list, place, work3(list, place) + y);
        two = one;
        one = y;
    }
}

/// Displacement of the point after `i` when its two predecessors are displaced by `before` and `here`.
fn followed(slot: u32, i: u32, before: vec3f, here: vec3f) -> vec3f {
    let two = matrix1(FOLLOW2, place_of(slot, max(i, 1u) - 1u));
    return here * -matrix1(FOLLOW, place_of(slot, i)) - before * two;
}

fn damped(slot: u32, i: u32) -> f32 {
    let place = place_of(slot, min(i, step_of.points - 1u));
    let c = (1.0 + matrix1(GAMMA, place)) * matrix1(STIFFNESS, place);
    return select(0.0, c, i < step_of.points);
}

/// Number of links with a free end.
fn link_count() -> u32 {
    return step_of.points - min(step_of.first_free, step_of.points);
}

fn triangle() -> u32 {
    return link_count() * (link_count() + 1u) / 2u;
}

/// The place of a row and a column at or before it, of the response (0) or the factor (1), for links counted from the first
/// with a free end.
fn entry(which: u32, slot: u32, row: u32, column: u32) -> u32 {
    let n = which * triangle() + row * (row + 1u) / 2u + column;
    return MATRIX_LISTS * numbers() + (slot / SLOTS * (2u * triangle()) + n) * SLOTS + slot % SLOTS;
}

/// Numbers per slot behind the matrices: whether the factor is computed, and whether nothing resists bending.
const IS_COMPUTED = 0u;
const IS_CHAIN = 1u;

fn flag(which: u32, slot: u32) -> u32 {
    return MATRIX_LISTS * numbers() + 2u * triangle() * slots() + which * slots() + slot;
}

/// One thread per slot.
@compute @workgroup_size(64)
fn factorise(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let slot = id.x + id.y * groups.x * 64u;
    if slot >= slots() {
        return;
    }
    let count = step_of.points;
    let first = step_of.first_free;
    let link = of_slot(MEAN_LINK, slot);
    var is_chain = true;
    for (var i = 0u; i < count; i++) {
        let place = place_of(slot, i);
        let root_b = row_rate(i, ROW_STIFFNESS) * REFERENCE_LENGTH * REFERENCE_LENGTH / CANTILEVER;
        let c = step_of.h * root_b / (link * link + 1e-12) * rest1(STIFFNESS_FACTOR, place);
        let gamma = step_of.bend_gamma * rest1(DAMPING_FACTOR, place);
        // The end of a guide that was cut is a tip.
        var stiffness = 0.0;
        if i > 0u && i + 1u < count && rest1(INV_LENGTH, place_of(slot, min(i + 1u, count - 1u))) > 0.0 {
            stiffness = lesser(c * c, STIFFEST / (1.0 + gamma));
        }
        let reach = lesser(step_of.hold_reach, link * f32(count - 1u)) + 1e-6;
        let fades = greater(1.0 - link * f32(i) / reach, 0.0);
        var hold = step_of.h * row_rate(i, ROW_HOLD) * fades * fades * rest1(HOLD_FACTOR, place);
        let tie = rest1(TIE_HOLD, place);
        if tie >= 0.0 {
            hold = step_of.h * tie;
        }
        let bend = length_of(rest3(REST_BEND, place)) / (link + 1e-9);
        let sharpness = stiffness * (1.0 + gamma) * bend;
        put_matrix1(STIFFNESS, place, stiffness);
        put_matrix1(HOLD, place, hold * hold);
        put_matrix1(GAMMA, place, gamma);
        put_matrix1(HEAD_SHARE, place, sharpness / (sharpness + HALF_SHARPNESS));
        is_chain = is_chain && stiffness == 0.0 && hold == 0.0;
    }
    matrix[flag(IS_COMPUTED, slot)] = 0.0;
    matrix[flag(IS_CHAIN, slot)] = select(0.0, 1.0, is_chain);
    // L D L^T from the root, on the free points.
    for (var i = first; i < count; i++) {
        let place = place_of(slot, i);
        let left = damped(slot, i - 1u);
        let here = damped(slot, i);
        var pivot = 1.0 + matrix1(HOLD, place) + left + 4.0 * here + damped(slot, i + 1u);
        var l1 = 0.0;
        var l2 = 0.0;
        if i >= first + 2u {
            l2 = left * matrix1(INV_PIVOT, place_of(slot, i - 2u));
            pivot -= l2 * left;
        }
        if i > first {
            var off = -2.0 * (left + here);
            if i >= first + 2u {
                off -= left * matrix1(BELOW, place_of(slot, i - 1u));
            }
            l1 = off * matrix1(INV_PIVOT, place_of(slot, i - 1u));
            pivot -= l1 * off;
        }
        put_matrix1(BELOW, place, l1);
        put_matrix1(BELOW2, place, l2);
        put_matrix1(INV_PIVOT, place, 1.0 / pivot);
    }
    // U D U^T from the tip: how the free part beyond a point follows it.
    var inv = 0.0;
    var inv2 = 0.0;
    var beyond = 0.0;
    for (var n = 0u; n + first <= count; n++) {
        let i = count - 1u - n;
        let left = select(0.0, damped(slot, max(i, 1u) - 1u), i > 0u);
        let here = damped(slot, i);
        let right = damped(slot, i + 1u);
        var pivot = 1.0 + matrix1(HOLD, place_of(slot, i)) + left + 4.0 * here + right;
        var one = 0.0;
        var two = 0.0;
        if i + 2u < count {
            two = right * inv2;
            pivot -= two * right;
        }
        if i + 1u < count {
            let off = -2.0 * (here + right) - select(0.0, right * beyond, i + 2u < count);
            one = off * inv;
            pivot -= one * off;
        }
        inv2 = inv;
        inv = 1.0 / pivot;
        put_matrix1(FOLLOW, place_of(slot, i), one);
        put_matrix1(FOLLOW2, place_of(slot, i), two);
        beyond = one;
    }
}

/// One thread per slot: the lower triangle of `H = D A^-1 D^T`, three columns at a time. The residual is working memory.
@compute @workgroup_size(64)
fn response(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let slot = id.x + id.y * groups.x * 64u;
    if slot >= slots() || step_of.integrator != DIRECT {
        return;
    }
    let count = step_of.points;
    let first = step_of.first_free;
    for (var start = first; start < count; start += 3u) {
        let columns = min(3u, count - start);
        var one = vec3f(0.0);
        var two = vec3f(0.0);
        for (var i = first; i < count; i++) {
            var force = vec3f(0.0);
            for (var c = 0u; c < columns; c++) {
                let link = start + c;
                if i == link {
                    force[c] = 1.0;
                } else if i + 1u == link {
                    force[c] = -1.0;
                }
            }
            let place = place_of(slot, i);
            let y = eliminated(place, force, one, two);
            put_work3(RESIDUAL, place, y);
            two = one;
            one = y;
        }
        one = vec3f(0.0);
        two = vec3f(0.0);
        for (var n = 0u; n + first < count; n++) {
            let i = count - 1u - n;
            let place = place_of(slot, i);
            let y = substituted(slot, i, work3(RESIDUAL, place), one, two);
            // Row `i + 1` is the difference of the displacements of points `i + 1` and `i`.
            if n > 0u {
                put_row(slot, i + 1u, start, columns, one - y);
            }
            two = one;
            one = y;
        }
        put_row(slot, first, start, columns, one);
    }
}

fn put_row(slot: u32, row: u32, start: u32, columns: u32, value: vec3f) {
    let first = step_of.first_free;
    for (var c = 0u; c < columns; c++) {
        if start + c <= row {
            matrix[entry(0u, slot, row - first, start + c - first)] = value[c];
        }
    }
}
