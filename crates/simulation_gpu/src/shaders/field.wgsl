// The field of head and shoulders: lattices at rest, and maps from a pose to rest. Twins of `colliders/field`.

const NONE = 1e9;
/// Marks a missing rest position, in its first component.
const NOWHERE = LARGEST;
const NO_NODE = 0xffffffffu;

struct LatticePlace {
    // Index of the first of the eight lattice points around a point; `NO_NODE` outside.
    first: u32,
    fraction: vec3f,
}

fn lattice_place(p: vec3f, low: vec3f, spacing: f32, size: vec3u) -> LatticePlace {
    let q = (p - low) * (1.0 / spacing);
    let inside = all(q >= vec3f(0.0)) && all(q < vec3f(size - 1u)) && is_finite(q.x + q.y + q.z);
    let kept = select(vec3f(0.0), q, inside);
    let cell = vec3u(kept);
    let first = (cell.z * size.y + cell.y) * size.x + cell.x;
    return LatticePlace(select(NO_NODE, first, inside), kept - vec3f(cell));
}

/// The offset of lattice point `n` of eight from the first.
fn lattice_offset(n: u32, size: vec3u) -> u32 {
    return (n & 1u) + (n >> 1u & 1u) * size.x + (n >> 2u) * size.x * size.y;
}

fn node_place(p: vec3f) -> LatticePlace {
    return lattice_place(p, step_of.nodes_low, step_of.node_spacing, step_of.nodes_size);
}

/// The weighting of a node, plus 65,536 if the head alone moves it and the seven nodes after it.
fn node_word(n: u32) -> u32 {
    let size = step_of.distances_size;
    return field[size.x * size.y * size.z + n];
}

fn is_head_alone(first: u32) -> bool {
    if first == NO_NODE {
        return false;
    }
    return (node_word(first) & 0x10000u) != 0u;
}

struct RestDistance {
    // Whether the point is in the field.
    there: bool,
    value: f32,
    slope: vec3f,
}

fn distance_at_rest(p: vec3f) -> RestDistance {
    let size = step_of.distances_size;
    let at = lattice_place(p, step_of.distances_low, step_of.spacing, size);
    if at.first == NO_NODE {
        return RestDistance(false, 0.0, vec3f(0.0));
    }
    var corners_of = array<f32, 8>();
    var value = 0.0;
    for (var n = 0u; n < 8u; n++) {
        corners_of[n] = bitcast<f32>(field[at.first + lattice_offset(n, size)]);
        value += corners_of[n] * weight_of(n, at.fraction);
    }
    return RestDistance(true, value, gradient_of(corners_of, at.fraction) * (1.0 / step_of.spacing));
}

/// The direction of a gradient, and its length.
fn normal_of(slope: vec3f) -> Direction {
    let squared = dot(slope, slope);
    let inv = inv_sqrt(squared);
    let steepness = squared * inv;
    return Direction(select(slope * inv, vec3f(0.0, 1.0, 0.0), steepness <= 1e-6), steepness);
}

fn body4(at: u32) -> vec4f {
    return bitcast<vec4f>(vec4u(body[at], body[at + 1u], body[at + 2u], body[at + 3u]));
}

/// The image of `p` under the map at `at`.
fn body_image(at: u32, p: vec3f) -> vec3f {
    return (body4(at) * p.x + body4(at + 4u) * p.y + (body4(at + 8u) * p.z + body4(at + 12u))).xyz;
}

/// The image of `p` under the weighting `slot` at the fraction `t` of the step.
fn image_at_rest(p: vec3f, slot: u32, t: f32) -> vec3f {
    let before = body_image(16u * slot, p);
    return before + (body_image(16u * (step_of.maps + slot), p) - before) * t;
}

struct Cell {
    // Its word in the body: the weighting of the nearest other skin, whether the head is near, whether it is forced.
    word: u32,
    // Lower bound of the distance to the next cell, metres.
    to_next: f32,
}

fn cell_of(p: vec3f) -> Cell {
    let q = (p - step_of.cells_low) * (1.0 / step_of.cell_side);
    let size = vec3f(step_of.cells_size);
    if !is_finite(q.x + q.y + q.z) {
        return Cell(0u, 0.0);
    }
    if any(q < vec3f(0.0)) || any(q >= size) {
        let beyond = max(-q, q - size);
        return Cell(0u, greater(0.0, max(beyond.x, max(beyond.y, beyond.z))) * step_of.cell_side);
    }
    let whole = vec3u(q);
    let f = q - vec3f(whole);
    let side = min(f, 1.0 - f);
    let n = (whole.z * step_of.cells_size.y + whole.y) * step_of.cells_size.x + whole.x;
    return Cell(body[32u * step_of.maps + n], min(side.x, min(side.y, side.z)) * step_of.cell_side);
}
