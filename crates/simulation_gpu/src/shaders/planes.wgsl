// What is known of the field around each point: a nearby plane. Twins of `planes.rs` and `measure.rs`.

override NEAR: f32;

// Lists of the planes.
const PLANE_PLACE = PLANES;
const PLANE_VALID = PLANES + 3u;
const PLANE_PASSED = PLANES + 4u;
const PLANE_HEAD_DISTANCE = PLANES + 5u;
const PLANE_HEAD_NORMAL = PLANES + 6u;
const PLANE_SKIN_DISTANCE = PLANES + 9u;
const PLANE_SKIN_NORMAL = PLANES + 10u;
const PLANE_SHARE = PLANES + 13u;
const PLANE_DRIFT = PLANES + 14u;
const PLANE_GUESS = PLANES + 17u;

/// One thread per point and slot, at the start of a step.
@compute @workgroup_size(64)
fn forget_planes(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let place = id.x + id.y * groups.x * 64u;
    if place < numbers() {
        put_work3(PLANE_PLACE, place, vec3f(0.0));
        put_work1(PLANE_VALID, place, -1.0);
        put_work1(PLANE_PASSED, place, 0.0);
        put_work1(PLANE_HEAD_DISTANCE, place, NONE);
        put_work1(PLANE_SKIN_DISTANCE, place, NONE);
    }
}

/// A point of working space in head space.
fn in_head(p: vec3f) -> vec3f {
    let head = head_map();
    return rotated_back(head, p - head.shift);
}

/// Measures the field again if the point `local` in head space has left its plane.
fn update_plane(place: u32, local: vec3f, reach: f32) {
    let off = local - work3(PLANE_PLACE, place);
    let squared = dot(off, off);
    let valid = work1(PLANE_VALID, place);
    if is_finite(squared) && squared <= valid {
        return;
    }
    let cell = cell_of(local);
    let slot = cell.word & 0xffffu;
    let forced = (cell.word & 0x20000u) != 0u;
    let near_head = (cell.word & 0x10000u) != 0u;
    // Skin that only the head moves.
    let alone = near_head && is_head_alone(node_place(local).first);
    var head_distance = NONE;
    var head_nearest = NONE;
    var head_normal = vec3f(0.0, 1.0, 0.0);
    if alone {
        let at_rest = distance_at_rest(local);
        if at_rest.there {
            let normal = normal_of(at_rest.slope);
            head_normal = normal.unit;
            let distance = at_rest.value / clamp(normal.length, 0.5, 2.0) - step_of.lift;
            let far = at_rest.value - step_of.lift > 2.0 * reach;
            head_nearest = select(distance, 0.5 * at_rest.value - step_of.lift, far);
            head_distance = select(distance, NONE, far);
        }
    }
    let other = near_head && !alone;
    var skin = no_skin();
    if other || slot != 0u {
        let was = state3(SKIN, place);
        skin = found_skin(local, was, valid >= 0.0, slot, other, alone, substep_of.passed, reach);
    }
    var nearest = select(skin.nearest, lesser(head_nearest, skin.nearest), alone);
    // Points that are measured only to verify the culling leave no trace unless skin is found.
    let nothing = forced && nearest > reach;
    nearest = select(nearest, NONE, nothing);
    let found = skin.found && !nothing;
    // Another cell may contain other skin, which this cell takes into account within a few millimetres.
    let to_next = cell.to_next + NEAR;
    let free = greater(lesser(0.5 * (nearest - reach), to_next), NEAR);
    let known = nearest < NONE;
    let only_head = alone && slot == 0u;
    let lost = (near_head || slot != 0u) && !forced;
    var radius = select(to_next, free, known && only_head);
    radius = select(radius, NEAR, (known && !only_head) || (!known && lost));
    put_work3(PLANE_PLACE, place, local);
    put_work1(PLANE_VALID, place, select(-1.0, radius * radius, is_finite(dot(local, local))));
    put_work1(PLANE_PASSED, place, substep_of.passed);
    put_work1(PLANE_HEAD_DISTANCE, place, select(head_distance, NONE, nothing));
    put_work3(PLANE_HEAD_NORMAL, place, head_normal);
    put_work1(PLANE_SKIN_DISTANCE, place, select(NONE, skin.distance, found));
    put_state3(SKIN, place, select(vec3f(NOWHERE), skin.rest, found));
    put_work3(PLANE_SKIN_NORMAL, place, skin.normal);
    put_work1(PLANE_SHARE, place, skin.share);
    put_work1(PLANE_GUESS, place, select(1.0, 0.0, skin.sure));
    put_work3(PLANE_DRIFT, place, skin.drift);
}

/// The field at a point, in working space; a huge distance far from it.
struct FieldPoint {
    distance: f32,
    normal: vec3f,
    // The head's weight at the skin.
    head: f32,
    // Velocity of the skin relative to the head.
    drift: vec3f,
    // 1 if the skin is a guess.
    guess: f32,
}

fn field_at(place: u32, p: vec3f, reach: f32) -> FieldPoint {
    let local = in_head(p);
    update_plane(place, local, reach);
    let head_distance = work1(PLANE_HEAD_DISTANCE, place);
    let skin_distance = work1(PLANE_SKIN_DISTANCE, place);
    if lesser(head_distance, skin_distance) >= NONE {
        return FieldPoint(NONE, vec3f(0.0), 0.0, vec3f(0.0), 0.0);
    }
    let head = head_map();
    let moved = local - work3(PLANE_PLACE, place);
    let drift = work3(PLANE_DRIFT, place);
    let n = work3(PLANE_HEAD_NORMAL, place);
    let m = work3(PLANE_SKIN_NORMAL, place);
    let secs = (substep_of.passed - work1(PLANE_PASSED, place)) * step_of.step_secs;
    let of_head = head_distance + dot(n, moved);
    var of_skin = skin_distance + dot(m, moved - drift * secs);
    var guess = work1(PLANE_GUESS, place);
    // Skin that approaches too fast to be measured on the way is a guess.
    if of_skin < -IMPLAUSIBLE_DEPTH {
        of_skin = -GUESSED_DEPTH;
        guess = 1.0;
    }
    if of_skin < of_head {
        return FieldPoint(of_skin, rotated(head, m), work1(PLANE_SHARE, place), rotated(head, drift), guess);
    }
    return FieldPoint(of_head, rotated(head, n), 1.0, vec3f(0.0), 0.0);
}

/// One thread per point and slot: measures in advance what the placement pass will need.
@compute @workgroup_size(64)
fn prefetch(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let place = id.x + id.y * groups.x * 64u;
    if place < numbers() && point_of(place) >= step_of.first_free {
        update_plane(place, in_head(work3(HELD, place)), step_of.reach);
    }
}
