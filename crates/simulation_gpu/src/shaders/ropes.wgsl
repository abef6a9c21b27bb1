// Gathered hair beyond a tie as one rope.

override ROPE_FREE: f32;
override ROPE_FASTEST: f32;

struct LinePoint {
    // Whether the point of the guide is in a rope.
    there: bool,
    position: vec3f,
    velocity: vec3f,
    // Where the numbers of the line are.
    line: u32,
}

/// The middle line next to a point of a guide.
fn line_of(slot: u32, place: u32) -> LinePoint {
    let beyond = rest1(ROPE_PLACE, place);
    let rope = of_slot(ROPE, slot);
    if rope < 0.0 || beyond < 0.0 || u32(rope) >= step_of.line_count {
        return LinePoint(false, vec3f(0.0), vec3f(0.0), 0u);
    }
    let line = step_of.lines + 5u * u32(rope);
    let count = u32(frame[line + 1u]);
    if count == 0u {
        return LinePoint(false, vec3f(0.0), vec3f(0.0), 0u);
    }
    let i = min(u32(beyond), count - 1u);
    let first = u32(frame[line]);
    let a = step_of.line_points + 6u * (first + i);
    let b = step_of.line_points + 6u * (first + min(i + 1u, count - 1u));
    let t = beyond - f32(i);
    let position = frame3(a) + (frame3(b) - frame3(a)) * t;
    let velocity = frame3(a + 3u) + (frame3(b + 3u) - frame3(a + 3u)) * t;
    return LinePoint(true, position, velocity, line);
}

/// The change of velocity in a step by which a point takes on the velocity of its rope.
fn rope_friction(slot: u32, place: u32, velocity: vec3f) -> vec3f {
    let line = line_of(slot, place);
    let relative = line.velocity - velocity;
    let squared = dot(relative, relative);
    let rubs = line.there && is_finite(squared) && squared < 1e6;
    return select(vec3f(0.0), relative * frame[line.line + 3u], rubs);
}

/// A point pulled into its rope; `passed` seconds have passed since the lines were computed.
fn held_in_rope(slot: u32, place: u32, p: vec3f, passed: f32) -> vec3f {
    let line = line_of(slot, place);
    if !line.there {
        return p;
    }
    let off = direction_or(p - (line.position + line.velocity * passed), vec3f(0.0));
    let bound = ROPE_FREE * greater(rest1(ROPE_RADIUS, place), frame[line.line + 4u]);
    let back = greater((bound - off.length) * frame[line.line + 2u], -ROPE_FASTEST * step_of.h);
    return select(p, p + off.unit * back, is_finite(off.length) && off.length > bound);
}
