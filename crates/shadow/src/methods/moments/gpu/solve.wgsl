// From moments to the share of hair before a depth. Twin of solve.rs.

// The least pivot with which the system counts as solvable.
const LEAST_PIVOT: f32 = 1e-12;

// The Cholesky factors of the matrix of a record with ORDER + 1 rows.
struct System {
    // Below the diagonal, row after row, five numbers each.
    l: array<f32, 25>,
    inverse: array<f32, 5>,
    // False for NaN.
    is_solvable: bool,
}

fn system_of(means: array<f32, 8>) -> System {
    var system: System;
    system.is_solvable = true;
    if (TURNED) {
        system.l = products_of(means);
    } else {
        let moments = power_moments(means);
        for (var row = 0u; row <= ORDER; row++) {
            for (var column = 0u; column <= row; column++) {
                system.l[5u * row + column] = moments[row + column];
            }
        }
    }
    for (var row = 0u; row <= ORDER; row++) {
        // Until the end of the row, L times D.
        for (var column = 0u; column < row; column++) {
            var entry = system.l[5u * row + column];
            for (var k = 0u; k < column; k++) {
                entry -= system.l[5u * row + k] * system.l[5u * column + k];
            }
            system.l[5u * row + column] = entry;
        }
        var pivot = system.l[6u * row];
        for (var k = 0u; k < row; k++) {
            let entry = system.l[5u * row + k] * system.inverse[k];
            pivot -= entry * system.l[5u * row + k];
            system.l[5u * row + k] = entry;
        }
        system.is_solvable = system.is_solvable && pivot > LEAST_PIVOT;
        system.inverse[row] = 1.0 / pivot;
    }
    return system;
}

// The share of hair before `z`. Only of a solvable system.
fn share_before(system: ptr<function, System>, z: f32) -> f32 {
    var own_place = vec2f(z, 1.0);
    var aside = vec2f(1.0, 0.0);
    if (TURNED) {
        own_place = half_turn(z);
        aside = vec2f(own_place.y, -own_place.x);
    }
    var reduced = reduced_of(system, own_place);
    let own = weight_at(system, &reduced);
    var k: array<f32, 5>;
    for (var up = 0u; up <= ORDER; up++) {
        let row = ORDER - up;
        var entry = reduced[row] * (*system).inverse[row];
        for (var below = row + 1u; below <= ORDER; below++) {
            entry -= (*system).l[5u * below + row] * k[below];
        }
        k[row] = entry;
    }
    var a: array<f32, 5>;
    if (TURNED) {
        a = rotated(k, own_place, own);
    } else {
        a = shifted(k, z, own);
    }
    let roots = real_roots(a);
    var all = own;
    var before = own * texels.overestimation;
    for (var i = 0u; i < ORDER; i++) {
        var place = roots[i] * own_place + aside;
        var part: f32;
        if (TURNED) {
            place *= 1.0 / sqrt(place.x * place.x + place.y * place.y);
            part = before_at(place);
        } else {
            part = select(0.0, 1.0, place.y < 0.0);
            // Hair infinitely far away has no weight.
            place = vec2f(place.x / select(place.y, 1e-6, abs(place.y) < 1e-6), 1.0);
        }
        reduced = reduced_of(system, place);
        let weight = weight_at(system, &reduced);
        all += weight;
        before += weight * part;
    }
    return before / all;
}

// L⁻¹ v of a depth.
fn reduced_of(system: ptr<function, System>, place: vec2f) -> array<f32, 5> {
    var entries: array<f32, 5>;
    if (TURNED) {
        entries = half_waves(place);
    } else {
        entries[0] = 1.0;
        for (var k = 1u; k <= ORDER; k++) {
            entries[k] = entries[k - 1u] * place.x;
        }
    }
    for (var row = 1u; row <= ORDER; row++) {
        for (var column = 0u; column < row; column++) {
            entries[row] -= (*system).l[5u * row + column] * entries[column];
        }
    }
    return entries;
}

// 1 / K(x, x) of L⁻¹ v(x).
fn weight_at(system: ptr<function, System>, reduced: ptr<function, array<f32, 5>>) -> f32 {
    var sum = 0.0;
    for (var k = 0u; k <= ORDER; k++) {
        sum += (*reduced)[k] * (*reduced)[k] * (*system).inverse[k];
    }
    return 1.0 / sum;
}

fn shifted(k: array<f32, 5>, z: f32, own: f32) -> array<f32, 5> {
    var a = k;
    for (var first = 0u; first < ORDER; first++) {
        for (var up = 1u; up <= ORDER - first; up++) {
            let at = ORDER - up;
            a[at] += a[at + 1u] * z;
        }
    }
    for (var at = 0u; at <= ORDER; at++) {
        a[at] *= own;
    }
    return a;
}

fn rotated(k: array<f32, 5>, place: vec2f, own: f32) -> array<f32, 5> {
    let by = half_waves(place);
    var w = k;
    for (var at = 0u; at < ORDER; at += 2u) {
        w[at] = k[at] * by[at] + k[at + 1u] * by[at + 1u];
        w[at + 1u] = k[at + 1u] * by[at] - k[at] * by[at + 1u];
    }
    var a: array<f32, 5>;
    if (ORDER == 2u) {
        a = array(w[0] + w[2], 2.0 * w[1], w[2] - w[0], 0.0, 0.0);
    } else if (ORDER == 3u) {
        a = array(w[0] + w[2], 3.0 * w[1] + w[3], w[2] - 3.0 * w[0], w[3] - w[1], 0.0);
    } else {
        a = array(
            w[0] + w[2] + w[4],
            4.0 * w[1] + 2.0 * w[3],
            2.0 * w[4] - 6.0 * w[0],
            2.0 * w[3] - 4.0 * w[1],
            w[0] - w[2] + w[4],
        );
    }
    for (var at = 0u; at <= ORDER; at++) {
        a[at] *= own;
    }
    return a;
}

// How much hair of a depth counts as before another one.
fn before_at(place: vec2f) -> f32 {
    let from_far_end = select(place.y, -place.y, place.x < 0.0);
    let side = select(0.0, 1.0, place.y < 0.0);
    return select(side, 0.5 - 0.5 * from_far_end / WRAPPING, abs(place.y) < WRAPPING);
}
