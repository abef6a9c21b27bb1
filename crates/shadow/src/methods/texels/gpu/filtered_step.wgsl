// Lines one texel wide, or pre-filtered lines if `texels.prefiltered` is set. A step then is one fragment in each of several texels
// across the longer axis, which share its weight: in the two nearest ones (1), or in all that a Gaussian profile reaches (2).
// Twin of lines.rs and gaussian.rs.

// Standard deviations on each side of a line that have texels of their own.
const REACH: f32 = 2.5;

// The cumulative normal distribution.
fn normal(x: f32) -> f32 {
    let z = abs(x) * 0.70710678;
    let t = 1.0 / (1.0 + 0.3275911 * z);
    var p = 1.0614054;
    p = p * t - 1.453152;
    p = p * t + 1.4214137;
    p = p * t - 0.28449674;
    p = p * t + 0.2548296;
    let half = 0.5 * (p * t) * exp_of_minus(z * z);
    return select(half, 1.0 - half, x > 0.0);
}

fn put_step(by_row: bool, major: i32, minor: f32, depth: f32, length: f32, width: f32) {
    let all = length * width * WEIGHT_ONE;
    let weight = u32(all + 0.5);
    let filtered = texels.prefiltered != 0u;
    let gaussian = texels.prefiltered == 2u;
    let deviation = texels.line_deviation * length;
    let reach = select(select(0.0, 0.5, filtered), REACH * deviation, gaussian);
    let count = select(select(1u, 2u, filtered), u32(ceil(2.0 * reach)) + 1u, gaussian);
    let at = minor - reach;
    let low = floor(at);
    let second = u32(all * (at - low) + 0.5);
    var before = 0u;
    for (var k = 1u; k <= count; k++) {
        var until = weight;
        if (k < count) {
            let part = normal((low + f32(k) - minor) / deviation);
            until = select(weight - second, u32(all * part + 0.5), gaussian);
        }
        until = clamp(until, before, weight);
        put(texel_of(by_row, major, i32(low) + i32(k) - 1), depth, until - before);
        before = until;
    }
}
