// What the kernels of a step share: constants of the step, lists of rows, and access to them. Lists are described in
// `lovelock_simulation::device`.

struct Step {
    rebase: vec3f,
    blocks: u32,
    grid_low: vec3f,
    points: u32,
    distances_low: vec3f,
    first_free: u32,
    nodes_low: vec3f,
    colliders: u32,
    cells_low: vec3f,
    substeps: u32,
    distances_size: vec3u,
    integrator: u32,
    nodes_size: vec3u,
    sweeps: u32,
    cells_size: vec3u,
    stride: u32,
    counts_nearest: u32,
    has_field: u32,
    windy: u32,
    maps: u32,
    rows: u32,
    shapes: u32,
    wind: u32,
    solids: u32,
    solid_count: u32,
    lines: u32,
    line_count: u32,
    line_points: u32,
    h: f32,
    gravity: f32,
    support: f32,
    settle: f32,
    settle_rate: f32,
    cohesion: f32,
    air_shelter: f32,
    opening: f32,
    margin: f32,
    layering: f32,
    skin_friction: f32,
    cloth_friction: f32,
    reach: f32,
    strength: f32,
    inv_threshold: f32,
    anisotropy: f32,
    cell: f32,
    units: f32,
    full_mass: f32,
    follow_damping: f32,
    bend_gamma: f32,
    hold_reach: f32,
    lift: f32,
    step_secs: f32,
    spacing: f32,
    node_spacing: f32,
    cell_side: f32,
    // Samples of the density grid per guide.
    samples: u32,
}

struct Substep {
    index: u32,
    // 1 where lengths are factorised again.
    checks_factor: u32,
    is_last: u32,
    // Fraction of the step that has passed at the end of the substep.
    passed: f32,
}

@group(0) @binding(0) var<uniform> step_of: Step;
@group(0) @binding(1) var<uniform> substep_of: Substep;
@group(0) @binding(2) var<storage, read_write> state: array<f32>;
@group(0) @binding(3) var<storage, read_write> work: array<f32>;
@group(0) @binding(4) var<storage, read> rest: array<f32>;
@group(0) @binding(5) var<storage, read_write> matrix: array<f32>;
@group(0) @binding(6) var<storage, read_write> grid: array<atomic<i32>>;
@group(0) @binding(7) var<storage, read> field: array<u32>;
@group(0) @binding(8) var<storage, read> body: array<u32>;
@group(0) @binding(9) var<storage, read> frame: array<f32>;
@group(0) @binding(10) var<storage, read_write> report: array<u32>;
@group(0) @binding(11) var<storage, read> rest_density: array<f32>;

const SLOTS = 16u;

// The integrators.
const DIRECT = 0u;
const RELAXATION = 1u;
const FOLLOW_THE_LEADER = 2u;

// Lists of the state, in lists of one number per point and slot.
const POSITION = 0u;
const VELOCITY = 3u;
const BEND = 6u;
const CONTACT_PUSH = 9u;
const DIRECTION = 12u;
const SKIN = 15u;

// Lists of the working memory.
const START_POSE = 0u;
const PUSH = 3u;
const NEXT = 6u;
const HELD = 9u;
const LINKS = 12u;
const RESIDUAL = 15u;
// Positions at the start of the substep, in the placement pass.
const PREVIOUS = 15u;
const KEEP = 18u;
const CARRIED = 19u;
const MULTIPLIER = 20u;
const UPPER = 21u;
const PLANES = 22u;
// Effects of the density grid, before the planes are known.
const GRID_PUSH = 22u;
const GRID_MEAN = 25u;
const GRID_INSIDE = 28u;

// Lists of what does not change during a motion.
const REST_POSITION = 0u;
const REST_DIRECTION = 3u;
const REST_BEND = 6u;
const REST_SUPPORT = 9u;
const REST_LENGTH = 12u;
const INV_LENGTH = 13u;
const LOCK_RADIUS = 14u;
const TIE_HOLD = 15u;
const STIFFNESS_FACTOR = 16u;
const HOLD_FACTOR = 17u;
const DAMPING_FACTOR = 18u;
const FRICTION_FACTOR = 19u;
const ROPE_PLACE = 20u;
const ROPE_RADIUS = 21u;
const GUIDE_NUMBERS = 22u;
// Numbers per slot behind those lists.
const MEAN_LINK = 0u;
const IS_USED = 1u;
const IS_IN_LOCK = 2u;
const ROPE = 3u;
const PER_SLOT = 4u;

// Lists of the matrices.
const STIFFNESS = 0u;
const HOLD = 1u;
const GAMMA = 2u;
const HEAD_SHARE = 3u;
const INV_PIVOT = 4u;
const BELOW = 5u;
const BELOW2 = 6u;
const FOLLOW = 7u;
const FOLLOW2 = 8u;
const MATRIX_LISTS = 9u;

// Offsets in the frame.
const LAST_HEAD = 0u;
const HEAD_FROM_LAST = 12u;
const SUBSTEPS = 24u;

/// Numbers of a list with one number per point and slot.
fn numbers() -> u32 {
    return step_of.blocks * step_of.points * SLOTS;
}

fn slots() -> u32 {
    return step_of.blocks * SLOTS;
}

/// The place of point `i` of `slot` in a list.
fn place_of(slot: u32, i: u32) -> u32 {
    return (slot / SLOTS * step_of.points + i) * SLOTS + slot % SLOTS;
}

fn slot_of(place: u32) -> u32 {
    return place / SLOTS / step_of.points * SLOTS + place % SLOTS;
}

fn point_of(place: u32) -> u32 {
    return place / SLOTS % step_of.points;
}

/// The first number of a vector at `place` of the lists from `list` on; the other axes follow at distances of `SLOTS`.
fn first_of(list: u32, place: u32) -> u32 {
    return list * numbers() + place / SLOTS * (3u * SLOTS) + place % SLOTS;
}

fn state3(list: u32, place: u32) -> vec3f {
    let at = first_of(list, place);
    return vec3f(state[at], state[at + SLOTS], state[at + 2u * SLOTS]);
}

fn put_state3(list: u32, place: u32, v: vec3f) {
    let at = first_of(list, place);
    state[at] = v.x;
    state[at + SLOTS] = v.y;
    state[at + 2u * SLOTS] = v.z;
}

fn work3(list: u32, place: u32) -> vec3f {
    let at = first_of(list, place);
    return vec3f(work[at], work[at + SLOTS], work[at + 2u * SLOTS]);
}

fn put_work3(list: u32, place: u32, v: vec3f) {
    let at = first_of(list, place);
    work[at] = v.x;
    work[at + SLOTS] = v.y;
    work[at + 2u * SLOTS] = v.z;
}

fn work1(list: u32, place: u32) -> f32 {
    return work[list * numbers() + place];
}

fn put_work1(list: u32, place: u32, v: f32) {
    work[list * numbers() + place] = v;
}

fn rest3(list: u32, place: u32) -> vec3f {
    let at = first_of(list, place);
    return vec3f(rest[at], rest[at + SLOTS], rest[at + 2u * SLOTS]);
}

fn rest1(list: u32, place: u32) -> f32 {
    return rest[list * numbers() + place];
}

fn of_slot(list: u32, slot: u32) -> f32 {
    return rest[GUIDE_NUMBERS * numbers() + list * slots() + slot];
}

/// Distances at rest follow the lists and the numbers per slot.
fn field_distance(place: u32) -> f32 {
    return rest[GUIDE_NUMBERS * numbers() + PER_SLOT * slots() + place];
}

fn collider_distance(collider: u32, slot: u32, i: u32) -> f32 {
    let row = (slot / SLOTS * step_of.colliders + collider) * step_of.points + i;
    return rest[(GUIDE_NUMBERS + 1u) * numbers() + PER_SLOT * slots() + row * SLOTS + slot % SLOTS];
}

fn matrix1(list: u32, place: u32) -> f32 {
    return matrix[list * numbers() + place];
}

fn put_matrix1(list: u32, place: u32, v: f32) {
    matrix[list * numbers() + place] = v;
}

fn frame3(at: u32) -> vec3f {
    return vec3f(frame[at], frame[at + 1u], frame[at + 2u]);
}

struct Map {
    x: vec3f,
    y: vec3f,
    z: vec3f,
    shift: vec3f,
}

fn map_at(at: u32) -> Map {
    return Map(frame3(at), frame3(at + 3u), frame3(at + 6u), frame3(at + 9u));
}

fn rotated(map: Map, v: vec3f) -> vec3f {
    return map.x * v.x + map.y * v.y + map.z * v.z;
}

fn mapped(map: Map, p: vec3f) -> vec3f {
    return rotated(map, p) + map.shift;
}

/// The rotation by the transpose.
fn rotated_back(map: Map, v: vec3f) -> vec3f {
    return vec3f(dot(map.x, v), dot(map.y, v), dot(map.z, v));
}

fn head_map() -> Map {
    return map_at(SUBSTEPS + 28u * substep_of.index);
}

fn head_turn() -> vec4f {
    let at = SUBSTEPS + 28u * substep_of.index + 12u;
    return vec4f(frame3(at), frame[at + 3u]);
}

/// From a position to the velocity of a point that moves with the head.
fn rigid_map() -> Map {
    return map_at(SUBSTEPS + 28u * substep_of.index + 16u);
}

/// The point of sample `n` of the density grid along a guide.
fn sampled_point(n: u32) -> u32 {
    return min(n * step_of.stride, step_of.points - 1u);
}

// What changes along a guide.
const ROW_COHESION = 0u;
const ROW_LOCK_FRICTION = 1u;
const ROW_DRAG = 2u;
const ROW_HAIR_FRICTION = 3u;
const ROW_STIFFNESS = 4u;
const ROW_HOLD = 5u;

fn row_rate(i: u32, rate: u32) -> f32 {
    return frame[step_of.rows + 6u * i + rate];
}
