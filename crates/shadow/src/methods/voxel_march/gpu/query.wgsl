// The march from a point to the light. Twin of march.rs and grid.rs.

@group(0) @binding(3) var<storage, read> index: array<u32>;
@group(0) @binding(5) var<storage, read> list: array<u32>;

// Lights that stand somewhere are followed here, so points are never projected.
override PROJECTED: bool = false;

// Hair that begins farther away than this is not seen, cells.
const FARTHEST: f32 = 1e6;
const ENDLESS: f32 = 1e30;

// A hash of a position, the same within a cube of an eighth of a millimetre. Twin of `place_hash` in texels/lookup.rs.
fn place_hash(p: vec3f) -> f32 {
    var v = bitcast<vec3u>(vec3i(floor(p * 8192.0))) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3u(16u);
    v.x += v.y * v.z;
    return f32(v.x >> 8u) * (1.0 / 16777216.0);
}

fn mix_of(a: f32, b: f32, t: f32) -> f32 {
    return a + (b - a) * t;
}

fn row_of(at: u32, part: f32) -> f32 {
    return mix_of(f32(min(list[at], MOST)), f32(min(list[at + 1u], MOST)), part);
}

// Density between the centres of cells, at a place within a brick, in fixed point.
fn density_in(number: u32, within: vec3f) -> f32 {
    let cell = min(vec3u(within), vec3u(BRICK - 1u));
    let part = within - vec3f(cell);
    let first = HEAD + (number - 1u) * BRICK_WORDS + cell.x + STORED * (cell.y + STORED * cell.z);
    let plane = STORED * STORED;
    let near = mix_of(row_of(first, part.x), row_of(first + STORED, part.x), part.y);
    let far = mix_of(row_of(first + plane, part.x), row_of(first + plane + STORED, part.x), part.y);
    return mix_of(near, far, part.z);
}

// The steps from a place within a brick to the first one that is not.
fn steps_out(within: vec3f, along: vec3f) -> i32 {
    let side = select(vec3f(0.0), vec3f(f32(BRICK)), along > vec3f(0.0));
    var out = ENDLESS;
    for (var axis = 0u; axis < 3u; axis++) {
        if (along[axis] != 0.0) {
            out = min(out, (side[axis] - within[axis]) / along[axis]);
        }
    }
    return i32(clamp(ceil(out / march.step_length), 1.0, 64.0));
}

fn hair_transmittance(p: vec3f) -> f32 {
    // False for NaN.
    if (march.bricks.x == 0u || !(dot(abs(p), vec3f(1.0)) < ENDLESS)) {
        return 1.0;
    }
    var along = march.light;
    var far = ENDLESS;
    if (march.radius >= 0.0) {
        let way = march.light - p;
        let from_light = length(way);
        if (!(from_light > march.radius && from_light < ENDLESS)) {
            return 1.0;
        }
        along = way / from_light;
        far = (from_light - march.radius) * march.per_cell;
    }
    let start = window_from_world(p);
    let size = vec3f(march.bricks * BRICK);
    var near = 0.0;
    for (var axis = 0u; axis < 3u; axis++) {
        if (along[axis] == 0.0) {
            if (!(start[axis] >= 0.0 && start[axis] <= size[axis])) {
                return 1.0;
            }
            continue;
        }
        let inverse = 1.0 / along[axis];
        let a = -start[axis] * inverse;
        let b = (size[axis] - start[axis]) * inverse;
        near = max(near, min(a, b));
        far = min(far, max(a, b));
    }
    if (!(near < far && near < FARTHEST)) {
        return 1.0;
    }
    let part = select(0.5, place_hash(p), march.jitter != 0u);
    var sum = 0.0;
    var i = i32(max(ceil(near / march.step_length - part), 0.0));
    loop {
        let t = (f32(i) + part) * march.step_length;
        if (!(t < far)) {
            break;
        }
        let q = start + along * t - 0.5;
        let brick = floor(q * (1.0 / f32(BRICK)));
        if (!(all(brick >= vec3f(0.0)) && all(brick < vec3f(march.bricks)))) {
            i++;
            continue;
        }
        let number = index[brick_at(vec3u(brick))];
        let within = q - brick * f32(BRICK);
        if (number == 0u || number > march.room) {
            i += steps_out(within, along);
            continue;
        }
        sum += density_in(number, within);
        i++;
    }
    return exp_of_minus(sum * (march.step_length / DEPTH_ONE));
}
