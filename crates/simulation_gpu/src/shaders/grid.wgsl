// The density grid: hair is deposited in integers, so that the order does not matter, and acts on hair.

override FULL: f32;
override MOMENTUM: f32;
override FASTEST_HAIR: f32;
override MAX_SHARE_OF_A_CELL: f32;
override NEAR_CENTRE: f32;
override LOST_ALONG: f32;
override UNIT: f32;
override CELLS_X: u32;
override CELLS_Y: u32;
override CELLS_Z: u32;

// Numbers per cell: mass, momentum, directions, and the bits of the excess.
const CELL_NUMBERS = 11u;
const EXCESS = 10u;
// Before the cells: the number of over-dense cells, and the sum of masses that count.
const OVER_DENSE = 0u;
const FULLNESS = 1u;
const FIRST_CELL = 2u;

fn cell_count() -> u32 {
    return CELLS_X * CELLS_Y * CELLS_Z;
}

struct Corners {
    base: u32,
    fraction: vec3f,
    inside: bool,
}

fn corners(p: vec3f) -> Corners {
    let q = (p - step_of.grid_low) / step_of.cell - 0.5;
    let last = vec3f(vec3u(CELLS_X, CELLS_Y, CELLS_Z) - 1u);
    let inside = all(q >= vec3f(0.0)) && all(q < last) && is_finite(q.x + q.y + q.z);
    let kept = select(vec3f(0.0), q, inside);
    let cell = vec3u(kept);
    return Corners((cell.z * CELLS_Y + cell.y) * CELLS_X + cell.x, kept - vec3f(cell), inside);
}

/// The first number of a cell.
fn numbers_of(cell: u32) -> u32 {
    return FIRST_CELL + cell * CELL_NUMBERS;
}

/// The first number of cell `n` of the eight around a point.
fn corner(base: u32, n: u32) -> u32 {
    return numbers_of(base + (n & 1u) + (n >> 1u & 1u) * CELLS_X + (n >> 2u) * CELLS_X * CELLS_Y);
}

@compute @workgroup_size(64)
fn clear_grid(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = id.x + id.y * groups.x * 64u;
    if n < numbers_of(cell_count()) {
        atomicStore(&grid[n], 0);
    }
}

fn tangent(slot: u32, i: u32) -> vec3f {
    let before = state3(POSITION, place_of(slot, max(i, 1u) - 1u));
    let after = state3(POSITION, place_of(slot, min(i + 1u, step_of.points - 1u)));
    return direction_or(after - before, vec3f(0.0)).unit;
}

fn outer(t: vec3f) -> array<f32, 6> {
    return array(t.x * t.x, t.y * t.y, t.z * t.z, t.x * t.y, t.x * t.z, t.y * t.z);
}

/// Number of points from `first` on in steps of the stride.
fn pieces_from(first: u32) -> u32 {
    let points = step_of.points;
    return select((points - first + step_of.stride - 1u) / step_of.stride, 0u, first >= points);
}

/// One thread per piece and slot.
@compute @workgroup_size(64)
fn deposit(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = id.x + id.y * groups.x * 64u;
    let points = step_of.points;
    let first = 1u + (step_of.stride - 1u) / 2u;
    let pieces = pieces_from(first);
    let slot = n / (SLOTS * pieces) * SLOTS + n % SLOTS;
    if slot >= slots() {
        return;
    }
    // In every second slot the points are shifted, so that neighbouring guides leave no gaps.
    let shift = select(0u, step_of.stride / 2u, slot % 2u == 1u);
    let i = first + n / SLOTS % pieces * step_of.stride + shift;
    if i >= points || of_slot(IS_USED, slot) == 0.0 || rest1(INV_LENGTH, place_of(slot, i)) <= 0.0 {
        return;
    }
    let place = place_of(slot, i);
    let head = map_at(HEAD_FROM_LAST);
    let at = corners(mapped(head, state3(POSITION, place)));
    var t = vec3f(0.0);
    if step_of.anisotropy > 0.0 {
        t = rotated(head, tangent(slot, i));
    }
    let u = state3(VELOCITY, place);
    let share = f32(points - 1u) / f32(max(pieces_from(first + shift), 1u)) * step_of.units;
    let mass = of_slot(MEAN_LINK, slot) * share;
    let known = is_finite(u.x + u.y + u.z) && is_finite(mass) && is_finite(t.x + t.y + t.z);
    if !known || !at.inside || dot(t, t) > UNIT || mass <= 0.0 || mass > FULL {
        return;
    }
    let slow = clamp(u, vec3f(-FASTEST_HAIR), vec3f(FASTEST_HAIR)) * MOMENTUM;
    let directions = outer(t);
    let fraction = select(at.fraction, step(vec3f(0.5), at.fraction), step_of.counts_nearest != 0u);
    for (var c = 0u; c < 8u; c++) {
        let weight = mass * weight_of(c, fraction);
        let cell = corner(at.base, c);
        atomicAdd(&grid[cell], i32(weight));
        for (var axis = 0u; axis < 3u; axis++) {
            atomicAdd(&grid[cell + 1u + axis], i32(weight * slow[axis]));
        }
        if step_of.anisotropy > 0.0 {
            for (var k = 0u; k < 6u; k++) {
                atomicAdd(&grid[cell + 4u + k], i32(weight * directions[k]));
            }
        }
    }
}

/// One thread per cell: how much denser it is than its threshold.
@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = id.x + id.y * groups.x * 64u;
    if n >= cell_count() {
        return;
    }
    let mass = atomicLoad(&grid[numbers_of(n)]);
    if mass <= 0 {
        return;
    }
    let excess = greater(0.0, f32(mass) * rest_density[n] * step_of.inv_threshold - 1.0);
    atomicStore(&grid[numbers_of(n) + EXCESS], bitcast<i32>(excess));
    if excess > 0.0 {
        atomicAdd(&grid[OVER_DENSE], 1);
    }
    atomicAdd(&grid[FULLNESS], min(mass, i32(clamp(step_of.full_mass, 1.0, 2e9))));
}

/// The published force: away from the centre of the cell that contains `p`, if that cell is over-dense.
fn away_from_centre(p: vec3f) -> vec3f {
    let q = vec3i((p - step_of.grid_low) / step_of.cell);
    let cell = vec3u(clamp(q, vec3i(0), vec3i(vec3u(CELLS_X, CELLS_Y, CELLS_Z)) - 1));
    let out = p - (step_of.grid_low + (vec3f(cell) + 0.5) * step_of.cell);
    let n = (cell.z * CELLS_Y + cell.y) * CELLS_X + cell.x;
    let excess = bitcast<f32>(atomicLoad(&grid[numbers_of(n) + EXCESS]));
    return out * (excess / (max(length_of(out), NEAR_CENTRE * step_of.cell) * step_of.cell));
}

/// One thread per sample and slot: the effect of the grid on a guide that is still where the last step left it.
@compute @workgroup_size(64)
fn sample_grid(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = id.x + id.y * groups.x * 64u;
    let slot = n / (SLOTS * step_of.samples) * SLOTS + n % SLOTS;
    if slot >= slots() {
        return;
    }
    let i = sampled_point(n / SLOTS % step_of.samples);
    let place = place_of(slot, i);
    let head = map_at(HEAD_FROM_LAST);
    let t = tangent(slot, i);
    let v = state3(VELOCITY, place);
    let p = mapped(head, state3(POSITION, place));
    let at = corners(p);
    var sums = array<f32, 10>();
    var excess = array<f32, 8>();
    var crowded = false;
    if at.inside {
        for (var c = 0u; c < 8u; c++) {
            let cell = corner(at.base, c);
            let weight = weight_of(c, at.fraction);
            for (var k = 0u; k < 10u; k++) {
                sums[k] += weight * f32(atomicLoad(&grid[cell + k]));
            }
            excess[c] = bitcast<f32>(atomicLoad(&grid[cell + EXCESS]));
            crowded = crowded || excess[c] > 0.0;
        }
    }
    let mass = sums[0];
    let found = mass >= 1.0;
    var dv = vec3f(0.0);
    var mean = v;
    if found {
        // The published force is isotropic.
        let anisotropy = select(step_of.anisotropy, 0.0, step_of.counts_nearest != 0u);
        var push = -gradient_of(excess, at.fraction) / step_of.cell;
        if step_of.counts_nearest != 0u && crowded {
            push = away_from_centre(p);
        }
        var crossing = 0.0;
        if crowded && step_of.anisotropy > 0.0 {
            let o = outer(rotated(head, t));
            let along = sums[4] * o[0] + sums[5] * o[1] + sums[6] * o[2]
                + 2.0 * (sums[7] * o[3] + sums[8] * o[4] + sums[9] * o[5]);
            crossing = clamp(1.0 - along / mass, 0.0, 1.0);
        }
        push = rotated(map_at(LAST_HEAD), push);
        push = (push - t * (anisotropy * dot(t, push))) * (1.0 + anisotropy * (1.5 * crossing - 0.5));
        dv = push * (step_of.strength * step_of.h);
        let most = MAX_SHARE_OF_A_CELL * step_of.cell / step_of.h;
        let size = dot(dv, dv);
        if size > most * most {
            dv = dv / sqrt(size) * most;
        }
        let around = vec3f(sums[1], sums[2], sums[3]) / (mass * MOMENTUM);
        mean = around - t * (LOST_ALONG * anisotropy * dot(t, around - v));
    }
    put_work3(GRID_PUSH, place, dv);
    put_work3(GRID_MEAN, place, mean);
    put_work1(GRID_INSIDE, place, lesser(mass / step_of.full_mass, 1.0));
}
