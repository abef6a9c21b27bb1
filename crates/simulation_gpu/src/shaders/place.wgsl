// The placement pass from root to tip: every link gets its length and every point a place outside the body. Twin of
// `contact.rs` and of the last part of `substep.rs`. One thread per slot.

override BESIDE_BOX: f32;
override CONTACT_RADIUS: f32;
override LAYER_HEIGHT: f32;
override SLACK: f32;
override ITERATIONS: u32;
override BARE_FROM: u32;
override TOLERANCE: f32;
override EXIT_SLOPE: f32;
override LEAST_GUESSED_DEPTH: f32;

/// Words of the report per slot.
const CONTACT_WORDS = 5u;
const OF_FIELD = 0xffffffffu;

/// The corners of the boxes of the guides of a workgroup.
var<workgroup> lows: array<vec3f, 64>;
var<workgroup> highs: array<vec3f, 64>;

/// Margin and layering; both 0 once a point lies between two colliders.
struct Rules {
    margin: f32,
    layering: f32,
}

fn reach_of(rules: Rules) -> f32 {
    return rules.margin + rules.layering * LAYER_HEIGHT;
}

/// The distance to a surface that is allowed at the rest distance `at_rest`, where `keep` of the height is kept and the root is
/// enclosed by `enclosed`.
fn allowed_at(rules: Rules, at_rest: f32, keep: f32, enclosed: f32, slope: f32) -> f32 {
    let height = lesser(greater(at_rest, 0.0), LAYER_HEIGHT);
    let allowed = lesser(at_rest - SLACK, rules.margin + rules.layering * keep * height);
    return allowed - greater(enclosed - slope, 0.0);
}

/// How much deeper than at rest the last carried point is inside the collider at `at`.
fn enclosed_by(slot: u32, carried: u32, collider: u32, at: u32) -> f32 {
    if frame[at + SHAPE_ON_HEAD] != 0.0 {
        return 0.0;
    }
    let now = nearest_on(at, work3(HELD, place_of(slot, carried)), vec3f(0.0)).distance;
    return greater(lesser(collider_distance(collider, slot, carried), 0.0) - now, 0.0);
}

/// Coulomb friction: `p` after a substep in which the surface moved at `surface`.
fn slide(p: vec3f, was: vec3f, centre: vec3f, depth: f32, friction: f32, surface: vec3f) -> vec3f {
    let normal = direction_or(p - centre, vec3f(0.0, 1.0, 0.0)).unit;
    let relative = p - was - surface * step_of.h;
    let tangential = relative - normal * dot(relative, normal);
    let lost = lesser(1.0, friction * greater(depth, 0.0) / (length_of(tangential) + 1e-9));
    return p - tangential * lost;
}

/// The point on the sphere at distance `length` from `before` whose direction is closest to that of `p`.
fn push_out(before: vec3f, p: vec3f, length: f32, centre: vec3f, radius: f32) -> vec3f {
    let to_centre = direction_or(centre - before, vec3f(0.0, -1.0, 0.0));
    let e = to_centre.unit;
    let distance = to_centre.length;
    let d = direction_or(p - before, -e).unit;
    let beside = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), e.x * e.x < 0.5);
    let across = direction_or(d - e * dot(d, e), beside - e * dot(beside, e)).unit;
    let cosine = (length * length + distance * distance - radius * radius) / (2.0 * length * distance + 1e-20);
    let c = lesser(greater(cosine, -1.0), 1.0);
    let s = sqrt(greater(1.0 - c * c, 0.0));
    return before + direction_or(e * c + across * s, d).unit * length;
}

fn friction_of(head: f32, iteration: u32) -> f32 {
    let both = step_of.cloth_friction + (step_of.skin_friction - step_of.cloth_friction) * head;
    return select(0.0, both, iteration == 0u);
}

struct Placed {
    p: vec3f,
    touched: bool,
}

/// Point `i` outside the field and the colliders, starting at `start`, at the distance `length` from `before`.
fn outside(slot: u32, i: u32, before: vec3f, start: vec3f, was: vec3f, length: f32, carried: u32, in_field: f32) -> Placed {
    let place = place_of(slot, i);
    let rub = rest1(FRICTION_FACTOR, place);
    let slope = EXIT_SLOPE * of_slot(MEAN_LINK, slot) * (f32(i) - f32(carried));
    var p = start;
    var touched = false;
    for (var iteration = 0u; iteration < ITERATIONS; iteration++) {
        let bare = iteration >= BARE_FROM;
        let rules = Rules(select(step_of.margin, 0.0, bare), select(step_of.layering, 0.0, bare));
        let enough = select(TOLERANCE, 0.0, iteration == 0u);
        var pushed = false;
        if step_of.has_field != 0u {
            let found = field_at(place, p, reach_of(rules));
            let depth = allowed_at(rules, field_distance(place), found.head, in_field, slope) - found.distance;
            if depth > enough {
                pushed = true;
                let centre = p - found.normal * (found.distance + CONTACT_RADIUS);
                let surface = mapped(rigid_map(), p) + found.drift;
                let slid = slide(p, was, centre, depth, friction_of(found.head, iteration) * rub, surface);
                p = push_out(before, slid, length, centre, CONTACT_RADIUS + depth + found.distance);
            }
        }
        let reach = reach_of(rules);
        for (var c = 0u; c < step_of.colliders; c++) {
            let at = collider_at(c);
            if is_apart(p, p, at, reach) {
                continue;
            }
            let on_head = frame[at + SHAPE_ON_HEAD];
            let found = nearest_on(at, p, p - before);
            let enclosed = enclosed_by(slot, carried, c, at);
            let allowed = allowed_at(rules, collider_distance(c, slot, i), on_head, enclosed, slope);
            let depth = allowed - found.distance;
            if depth > enough {
                pushed = true;
                let surface = mapped(map_at(at + SHAPE_VELOCITY), p);
                let slid = slide(p, was, found.centre, depth, friction_of(on_head, iteration) * rub, surface);
                p = push_out(before, slid, length, found.centre, found.radius + allowed);
            }
        }
        if !pushed {
            break;
        }
        touched = true;
    }
    return Placed(p, touched);
}

struct Depth {
    metres: f32,
    collider: u32,
    is_unsure: bool,
}

/// Penetration of point `i` into the field and the colliders.
fn penetration(slot: u32, i: u32, p: vec3f, carried: u32, in_field: f32) -> Depth {
    let place = place_of(slot, i);
    let slope = EXIT_SLOPE * of_slot(MEAN_LINK, slot) * (f32(i) - f32(carried));
    let bare = Rules(0.0, 0.0);
    var worst = Depth(0.0, OF_FIELD, false);
    if step_of.has_field != 0u {
        let found = field_at(place, p, step_of.reach);
        let allowed = allowed_at(bare, field_distance(place), found.head, in_field, slope);
        let depth = greater(0.0, allowed - found.distance);
        worst.metres = depth * (1.0 - found.guess);
        worst.is_unsure = found.guess > 0.0 && depth > LEAST_GUESSED_DEPTH;
    }
    for (var c = 0u; c < step_of.colliders; c++) {
        let at = collider_at(c);
        if is_apart(p, p, at, step_of.reach) {
            continue;
        }
        let enclosed = enclosed_by(slot, carried, c, at);
        let allowed = allowed_at(bare, collider_distance(c, slot, i), 0.0, enclosed, slope);
        let depth = allowed - nearest_on(at, p, vec3f(0.0)).distance;
        if depth > worst.metres {
            worst.metres = depth;
            worst.collider = c;
        }
    }
    return worst;
}

/// Whether a collider may touch a guide of the block of this thread. All threads of a workgroup take part.
fn block_touches(slot: u32, thread: u32) -> bool {
    var low = vec3f(LARGEST);
    var high = vec3f(-LARGEST);
    if slot < slots() {
        for (var i = 0u; i < step_of.points; i++) {
            let p = work3(HELD, place_of(slot, i));
            low = min(low, p);
            high = max(high, p);
        }
    }
    lows[thread] = low;
    highs[thread] = high;
    workgroupBarrier();
    let first = thread / SLOTS * SLOTS;
    for (var k = 0u; k < SLOTS; k++) {
        low = min(low, lows[first + k]);
        high = max(high, highs[first + k]);
    }
    var touches = step_of.has_field != 0u;
    for (var c = 0u; c < step_of.colliders; c++) {
        touches = touches || !is_apart(low, high, collider_at(c), step_of.reach + BESIDE_BOX);
    }
    return touches;
}

/// Places the points of a guide from root to tip, and writes the velocities that follow.
fn place_guide(slot: u32, touches: bool) {
    let carried = step_of.first_free - 1u;
    var in_field = 0.0;
    if step_of.has_field != 0u {
        let place = place_of(slot, carried);
        let found = field_at(place, work3(HELD, place), LAYER_HEIGHT);
        in_field = greater(lesser(field_distance(place), 0.0) - found.distance, 0.0);
    }
    var before = vec3f(0.0);
    var was_before = vec3f(0.0);
    var moved = vec3f(0.0);
    var moved_before = vec3f(0.0);
    var deepest = Depth(0.0, OF_FIELD, false);
    var deepest_point = 0u;
    var unsure = 0u;
    var first_unsure = 0u;
    for (var i = 0u; i < step_of.points; i++) {
        let place = place_of(slot, i);
        let was = state3(POSITION, place);
        let wanted = work3(HELD, place);
        var p = wanted;
        if i >= step_of.first_free {
            if step_of.integrator != FOLLOW_THE_LEADER {
                p += followed(slot, i - 1u, moved_before, moved);
            }
            var length = rest1(REST_LENGTH, place);
            if step_of.integrator == RELAXATION {
                length = length_of(p - before);
            }
            let fallback = (was - was_before) * rest1(INV_LENGTH, place);
            p = before + direction_or(p - before, fallback).unit * length;
            if touches {
                let free = p;
                let placed = outside(slot, i, before, free, was, length, carried, in_field);
                p = placed.p;
                let push = p - free;
                let sum = state3(CONTACT_PUSH, place) + push;
                put_state3(CONTACT_PUSH, place, select(vec3f(0.0), sum, dot(push, push) > 0.0));
                if placed.touched && substep_of.is_last != 0u {
                    let found = penetration(slot, i, p, carried, in_field);
                    if found.is_unsure {
                        first_unsure = select(first_unsure, i, unsure == 0u);
                        unsure += 1u;
                    }
                    if found.metres > deepest.metres {
                        deepest = found;
                        deepest_point = i;
                    }
                }
            } else {
                put_state3(CONTACT_PUSH, place, vec3f(0.0));
            }
        }
        moved_before = moved;
        moved = p - wanted;
        put_state3(POSITION, place, p);
        put_work3(PREVIOUS, place, was);
        put_state3(VELOCITY, place, (p - was) * (1.0 / step_of.h));
        before = p;
        was_before = was;
    }
    if substep_of.is_last != 0u {
        let at = CONTACT_WORDS * slot;
        report[at] = bitcast<u32>(deepest.metres);
        report[at + 1u] = deepest_point;
        report[at + 2u] = deepest.collider;
        report[at + 3u] = unsure;
        report[at + 4u] = first_unsure;
    }
}

/// Removes the velocities that exist only because contacts pushed points out, and the energy that the pass has added.
fn calm(slot: u32) {
    let rigid = rigid_map();
    let inv_h = 1.0 / step_of.h;
    var energy_before = 0.0;
    var energy_after = 0.0;
    for (var i = 0u; i < step_of.points; i++) {
        let place = place_of(slot, i);
        let p = state3(POSITION, place);
        let back = work3(HELD, place) - p;
        var v = state3(VELOCITY, place);
        let out = direction_or(-back * inv_h, vec3f(0.0));
        let relative = v - mapped(rigid, work3(PREVIOUS, place));
        v -= out.unit * greater(0.0, lesser(dot(relative, out.unit), out.length));
        put_state3(VELOCITY, place, v);
        if i >= step_of.first_free {
            let own = v - mapped(rigid, p);
            let free = own + back * inv_h;
            energy_before += dot(free, free);
            energy_after += dot(own, own);
        }
    }
    if !(energy_after > energy_before) {
        return;
    }
    let keep = sqrt(energy_before / energy_after);
    for (var i = step_of.first_free; i < step_of.points; i++) {
        let place = place_of(slot, i);
        let head = mapped(rigid, state3(POSITION, place));
        put_state3(VELOCITY, place, head + (state3(VELOCITY, place) - head) * keep);
    }
}

/// Gives each leader a part of its follower's correction with the opposite sign.
fn correct_velocities(slot: u32) {
    let scale = step_of.follow_damping / step_of.h;
    for (var i = step_of.first_free; i + 1u < step_of.points; i++) {
        let place = place_of(slot, i);
        let after = place_of(slot, i + 1u);
        let link = work3(HELD, after) - state3(POSITION, place);
        let direction = direction_or(link, link);
        let by = (rest1(REST_LENGTH, after) - direction.length) * scale;
        put_state3(VELOCITY, place, state3(VELOCITY, place) - direction.unit * by);
    }
}

@compute @workgroup_size(64)
fn place_points(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let slot = id.x + id.y * groups.x * 64u;
    let touches = block_touches(slot, thread);
    if slot >= slots() {
        return;
    }
    place_guide(slot, touches);
    if touches && step_of.integrator == DIRECT {
        calm(slot);
    }
    if step_of.integrator == FOLLOW_THE_LEADER {
        correct_velocities(slot);
    }
}
