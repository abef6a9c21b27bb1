// Skin that other joints than the head move: points are mapped back to the rest pose and measured there. Twins of `skins.rs`
// and `search.rs`.

override CONVERGED: f32;
override ROUNDS: u32;
override FURTHEST_FROM_GUESS: f32;
override SAME_START: f32;
override GUESSED_DEPTH: f32;
override IMPLAUSIBLE_DEPTH: f32;
override LEAST_DETERMINANT: f32;

struct Skin {
    found: bool,
    // Whether it is measured; otherwise it is a guess that may push only a little.
    sure: bool,
    // Lower bound of the distance, metres.
    nearest: f32,
    distance: f32,
    normal: vec3f,
    // The head's weight.
    share: f32,
    // Velocity relative to the head.
    drift: vec3f,
    rest: vec3f,
}

fn no_skin() -> Skin {
    return Skin(false, true, NONE, NONE, vec3f(0.0), 0.0, vec3f(0.0), vec3f(NOWHERE));
}

struct RestPlace {
    there: bool,
    sure: bool,
    // Whether the head alone moves the point.
    is_of_head: bool,
    place: vec3f,
    // The first of the nodes around it; not used where the place is a guess.
    first: u32,
    fraction: vec3f,
    // Rows of the derivative of the rest position, apart from the effect of the weightings.
    x: vec3f,
    y: vec3f,
    z: vec3f,
}

/// Solves `X = V(X)` from the first guess `start`; see `rest_positions`.
fn rest_place(p: vec3f, start: vec3f, t: f32) -> RestPlace {
    let size = step_of.nodes_size;
    let unit_x = vec3f(1.0, 0.0, 0.0);
    let unit_y = vec3f(0.0, 1.0, 0.0);
    let unit_z = vec3f(0.0, 0.0, 1.0);
    var out = RestPlace(true, false, false, start, 0u, vec3f(0.0), unit_x, unit_y, unit_z);
    for (var round_of = 0u; round_of < ROUNDS; round_of++) {
        let at = node_place(out.place);
        if at.first == NO_NODE {
            out.there = false;
            break;
        }
        if is_head_alone(at.first) {
            // Valid only if the point itself lies there.
            let own = node_place(p);
            out.is_of_head = true;
            out.sure = is_head_alone(own.first);
            out.there = own.first != NO_NODE;
            out.place = p;
            break;
        }
        out.first = at.first;
        out.fraction = at.fraction;
        var q = array<vec3f, 8>();
        var is_mixed = false;
        let slot = node_word(at.first) & 0xffffu;
        q[0] = image_at_rest(p, slot, t);
        for (var n = 1u; n < 8u; n++) {
            let other = node_word(at.first + lattice_offset(n, size)) & 0xffffu;
            if other == slot {
                q[n] = q[0];
            } else {
                q[n] = image_at_rest(p, other, t);
                is_mixed = true;
            }
        }
        var value = q[0];
        var along_x = vec3f(0.0);
        var along_y = vec3f(0.0);
        var along_z = vec3f(0.0);
        if is_mixed {
            let f = at.fraction;
            let e0 = q[0] + (q[1] - q[0]) * f.x;
            let e1 = q[2] + (q[3] - q[2]) * f.x;
            let e2 = q[4] + (q[5] - q[4]) * f.x;
            let e3 = q[6] + (q[7] - q[6]) * f.x;
            let low = e0 + (e1 - e0) * f.y;
            let high = e2 + (e3 - e2) * f.y;
            value = low + (high - low) * f.z;
            let s0 = (q[1] - q[0]) + ((q[3] - q[2]) - (q[1] - q[0])) * f.y;
            let s1 = (q[5] - q[4]) + ((q[7] - q[6]) - (q[5] - q[4])) * f.y;
            along_x = s0 + (s1 - s0) * f.z;
            along_y = (e1 - e0) + ((e3 - e2) - (e1 - e0)) * f.z;
            along_z = high - low;
        }
        let left_x = unit_x - along_x * (1.0 / step_of.node_spacing);
        let left_y = unit_y - along_y * (1.0 / step_of.node_spacing);
        let left_z = unit_z - along_z * (1.0 / step_of.node_spacing);
        let c0 = cross(left_y, left_z);
        let c1 = cross(left_z, left_x);
        let c2 = cross(left_x, left_y);
        let determinant = dot(left_z, c2);
        // Where the skin is folded over itself, no inverse keeps its sides apart.
        let newton = is_mixed && determinant >= LEAST_DETERMINANT;
        let inv = 1.0 / select(1.0, determinant, newton);
        out.x = select(unit_x, c0 * inv, newton);
        out.y = select(unit_y, c1 * inv, newton);
        out.z = select(unit_z, c2 * inv, newton);
        let off = value - out.place;
        var by = vec3f(dot(out.x, off), dot(out.y, off), dot(out.z, off));
        let squared = dot(by, by);
        let most = step_of.node_spacing;
        if newton && squared > most * most {
            by *= most / sqrt(squared);
        }
        out.place += by;
        if dot(by, by) < CONVERGED * CONVERGED {
            out.sure = true;
            break;
        }
    }
    let away = out.place - start;
    let furthest = FURTHEST_FROM_GUESS * step_of.node_spacing;
    out.sure = out.sure && dot(away, away) <= furthest * furthest;
    if out.there && !out.sure {
        out.place = start;
        out.is_of_head = false;
    }
    if out.is_of_head || !out.sure {
        out.x = unit_x;
        out.y = unit_y;
        out.z = unit_z;
    }
    return out;
}

struct BodyMap {
    x: vec4f,
    y: vec4f,
    z: vec4f,
    shift: vec4f,
}

fn add_map(sum: BodyMap, at: u32, weight: f32) -> BodyMap {
    return BodyMap(
        sum.x + body4(at) * weight,
        sum.y + body4(at + 4u) * weight,
        sum.z + body4(at + 8u) * weight,
        sum.shift + body4(at + 12u) * weight,
    );
}

fn map_image(map: BodyMap, p: vec3f) -> vec3f {
    return (map.x * p.x + map.y * p.y + (map.z * p.z + map.shift)).xyz;
}

/// Measures `p` from the starting point `start`, which `slot` gave; 0 if it may not replace a missing solution. `alone` says
/// that the head alone moves the place of the point, so that a trial that ends there finds skin that is known already.
fn measured_skin(p: vec3f, start: vec3f, slot: u32, alone: bool, t: f32, reach: f32) -> Skin {
    let place = rest_place(p, start, t);
    var out = no_skin();
    if !place.there || (!place.sure && slot == 0u) || (alone && place.is_of_head) {
        return out;
    }
    let at_rest = distance_at_rest(place.place);
    if !at_rest.there {
        return out;
    }
    if at_rest.value - step_of.lift > 2.0 * reach {
        // Stretched skin is further away than at rest, by at most half.
        out.nearest = 0.5 * at_rest.value - step_of.lift;
        return out;
    }
    var before = BodyMap(vec4f(0.0), vec4f(0.0), vec4f(0.0), vec4f(0.0));
    var now = before;
    if place.is_of_head {
        before = BodyMap(
            vec4f(1.0, 0.0, 0.0, 0.0),
            vec4f(0.0, 1.0, 0.0, 0.0),
            vec4f(0.0, 0.0, 1.0, 0.0),
            vec4f(0.0, 0.0, 0.0, 1.0),
        );
        now = before;
    } else if !place.sure {
        before = add_map(before, 16u * slot, 1.0);
        now = add_map(now, 16u * (step_of.maps + slot), 1.0);
    } else {
        for (var n = 0u; n < 8u; n++) {
            let of_node = node_word(place.first + lattice_offset(n, step_of.nodes_size)) & 0xffffu;
            let weight = weight_of(n, place.fraction);
            before = add_map(before, 16u * of_node, weight);
            now = add_map(now, 16u * (step_of.maps + of_node), weight);
        }
    }
    let back = BodyMap(
        before.x + (now.x - before.x) * t,
        before.y + (now.y - before.y) * t,
        before.z + (now.z - before.z) * t,
        before.shift + (now.shift - before.shift) * t,
    );
    let moved = map_image(before, p) - map_image(now, p);
    // The chain rule: dX = (1 - V')^-1 B dx.
    let g = at_rest.slope;
    let bent = place.x * g.x + place.y * g.y + place.z * g.z;
    let normal = normal_of(vec3f(dot(back.x.xyz, bent), dot(back.y.xyz, bent), dot(back.z.xyz, bent)));
    out.normal = normal.unit;
    let distance = at_rest.value / clamp(normal.length, 0.5, 2.0) - step_of.lift;
    let plausible = normal.length >= 0.5 && normal.length < 2.0 && distance > -IMPLAUSIBLE_DEPTH;
    out.sure = place.sure && plausible;
    out.distance = select(greater(distance, -GUESSED_DEPTH), distance, out.sure);
    out.found = true;
    out.nearest = out.distance;
    out.share = back.shift.w;
    let drift = vec3f(dot(back.x.xyz, moved), dot(back.y.xyz, moved), dot(back.z.xyz, moved));
    out.drift = drift * (1.0 / step_of.step_secs);
    out.rest = select(vec3f(NOWHERE), place.place, out.sure && !place.is_of_head);
    return out;
}

/// Takes a found skin if it is nearer than the known one.
fn merged(known: Skin, found: Skin) -> Skin {
    var out = known;
    if found.found && (!known.found || found.distance < known.distance) {
        out = found;
    }
    out.nearest = lesser(known.nearest, found.nearest);
    return out;
}

/// A starting point close to a known rest position would lead there again.
fn is_new_start(start: vec3f, tried: vec3f) -> bool {
    let off = start - tried;
    let close = SAME_START * step_of.node_spacing;
    return tried.x >= NOWHERE || dot(off, off) >= close * close;
}

/// Searches skin near `p`: from the last rest position `was`, from the images under the nearest other joints and under the head,
/// and from halfway between.
fn found_skin(
    p: vec3f, was: vec3f, in_this_step: bool, slot: u32, other: bool, alone: bool, t: f32, reach: f32
) -> Skin {
    var skin = no_skin();
    if slot != 0u && was.x < NOWHERE {
        let found = measured_skin(p, was, 0u, alone, t, reach);
        if found.found && found.sure {
            skin = found;
            skin.nearest = lesser(NONE, found.nearest);
        }
    }
    // Within a step a point stays on its side of a fold.
    if skin.rest.x < NOWHERE && in_this_step {
        return skin;
    }
    var tried = skin.rest;
    var guess = vec3f(0.0);
    if slot != 0u {
        guess = image_at_rest(p, slot, t);
        if is_new_start(guess, tried) {
            if tried.x >= NOWHERE {
                tried = guess;
            }
            // It would lead to the skin that moves with the head, which is known.
            if !(alone && is_head_alone(node_place(guess).first)) {
                skin = merged(skin, measured_skin(p, guess, slot, alone, t, reach));
            }
        }
    }
    if other && is_new_start(p, tried) {
        if tried.x >= NOWHERE {
            tried = p;
        }
        skin = merged(skin, measured_skin(p, p, 0u, alone, t, reach));
    }
    let between = 0.5 * (guess + p);
    if slot != 0u && is_new_start(between, tried) {
        skin = merged(skin, measured_skin(p, between, 0u, alone, t, reach));
    }
    return skin;
}
