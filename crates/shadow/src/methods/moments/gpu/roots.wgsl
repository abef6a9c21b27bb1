// The roots of polynomials all of whose roots are real. Twin of roots.rs.

const STEPS: u32 = 10u;
const LEAST_CHANGE: f32 = 1e-3;

// The roots of t^ORDER + a[1] t^(ORDER - 1) + … + a[ORDER].
fn real_roots(a: array<f32, 5>) -> array<f32, 4> {
    if (ORDER == 2u) {
        let both = quadratic(a[1], a[2]);
        return array(both.x, both.y, 0.0, 0.0);
    }
    let m = f32(ORDER);
    let mean = -a[1] / m;
    let spread = a[1] * a[1] - 2.0 * m / (m - 1.0) * a[2];
    let reach = (m - 1.0) / m * sqrt(select(0.0, spread, spread > 0.0));
    let low = outer_root(a, mean - reach);
    let high = outer_root(a, mean + reach);
    let is_low = abs(low) > abs(high);
    let large = select(high, low, is_low);
    let small = select(low, high, is_low);
    var rest = divided(a, ORDER, large);
    if (ORDER == 4u) {
        rest = divided(rest, 3u, small);
    }
    let both = quadratic(rest[1], rest[2]);
    if (ORDER == 3u) {
        return array(large, both.x, both.y, 0.0);
    }
    return array(large, small, both.x, both.y);
}

// The quotient of a polynomial of degree `n` by t − `root`, from both ends.
fn divided(a: array<f32, 5>, n: u32, root: f32) -> array<f32, 5> {
    var quotient: array<f32, 5>;
    quotient[0] = 1.0;
    for (var k = 1u; k < n; k++) {
        quotient[k] = a[k] + quotient[k - 1u] * root;
    }
    var meet = n;
    var largest = abs(a[n]);
    var power = 1.0;
    for (var up = 1u; up <= n; up++) {
        let k = n - up;
        power *= abs(root);
        let term = abs(a[k]) * power;
        if (term > largest) {
            meet = k;
            largest = term;
        }
    }
    if (root != 0.0) {
        var entry = -a[n] / root;
        for (var up = 1u; up < n; up++) {
            let k = n - up;
            if (k >= meet) {
                quotient[k] = entry;
            }
            entry = (entry - a[k]) / root;
        }
    }
    return quotient;
}

// The root next to `start`, which lies outside all of them.
fn outer_root(a: array<f32, 5>, start: f32) -> f32 {
    let m = f32(ORDER);
    var x = start;
    for (var step = 0u; step < STEPS; step++) {
        var value = 1.0;
        var slope = 0.0;
        var bend = 0.0;
        for (var k = 1u; k <= ORDER; k++) {
            bend = bend * x + slope;
            slope = slope * x + value;
            value = value * x + a[k];
        }
        let square = (m - 1.0) * ((m - 1.0) * slope * slope - 2.0 * m * value * bend);
        let root = sqrt(select(0.0, square, square > 0.0));
        let divisor = select(slope + root, slope - root, slope < 0.0);
        let change = select(m * value / divisor, 0.0, divisor == 0.0);
        x -= change;
        if (abs(change) <= LEAST_CHANGE * abs(x)) {
            break;
        }
    }
    return x;
}

fn quadratic(linear: f32, constant: f32) -> vec2f {
    let half = -0.5 * linear;
    let square = half * half - constant;
    let root = sqrt(select(0.0, square, square > 0.0));
    let outer = select(half + root, half - root, half < 0.0);
    return vec2f(outer, select(constant / outer, 0.0, outer == 0.0));
}
