// The wind at a point, and the wakes of the body in it.

override WAKE_LENGTH: f32;

/// `sin(2 pi t)` within 2e-4, by the polynomial of the definition.
fn sine_of_turns(turns: f32) -> f32 {
    let t = turns - round(turns);
    let folded = select(select(t, -0.5 - t, t < -0.25), 0.5 - t, t > 0.25);
    let x = folded * 6.2831855;
    let s = x * x;
    return x * (1.0 + s * (-1.0 / 6.0 + s * (1.0 / 120.0 - s * (1.0 / 5040.0))));
}

fn wind_at(p: vec3f) -> vec3f {
    var v = frame3(step_of.wind);
    for (var n = 0u; n < 9u; n++) {
        let at = step_of.wind + 3u + 7u * n;
        v += frame3(at) * sine_of_turns(dot(p, frame3(at + 3u)) + frame[at + 6u]);
    }
    return v;
}

/// The fraction of the wind that reaches a point.
fn exposure(p: vec3f) -> f32 {
    if step_of.solid_count == 0u {
        return 1.0;
    }
    let u = frame3(step_of.solids);
    var open = 1.0;
    for (var n = 0u; n < step_of.solid_count; n++) {
        let at = step_of.solids + 4u + 20u * n;
        let reach = frame[at + 3u];
        let ahead = frame3(at) - p;
        let far = dot(ahead, u);
        let near = 1.2 * reach;
        if far < -near || far > near + WAKE_LENGTH * reach || length_of(ahead - u * far) > near {
            continue;
        }
        let shape = at + 5u;
        var x = 0.0;
        var s = 0.0;
        var radius = 0.0;
        if frame[at + 4u] == 1.0 {
            let axis = frame3(shape + 3u);
            let r = p - frame3(shape);
            let b = dot(u, axis);
            let c = dot(u, r);
            let f = dot(axis, r);
            let e = dot(axis, axis);
            s = greater((b * f - c * e) / (e - b * b + 1e-9), 0.0);
            let t = lesser(greater((b * s + f) * frame[shape + 6u], 0.0), 1.0);
            s = greater(b * t - c, 0.0);
            radius = frame[shape + 8u] + t * frame[shape + 9u] + 1e-6;
            x = length_of(r + u * s - axis * t) / radius;
        } else {
            let r = p - frame3(shape);
            let inv = 1.0 / frame3(shape + 12u);
            let ax = frame3(shape + 3u);
            let ay = frame3(shape + 6u);
            let az = frame3(shape + 9u);
            let q = vec3f(dot(r, ax), dot(r, ay), dot(r, az)) * inv;
            let v = vec3f(dot(u, ax), dot(u, ay), dot(u, az)) * inv;
            s = greater(-dot(q, v) / dot(v, v), 0.0);
            radius = 1.0 / length_of(v);
            x = length_of(q + v * s);
        }
        let within = smooth_of((1.2 - x) * 2.0);
        let behind = smooth_of(s / (0.6 * radius));
        open *= 1.0 - within * behind * greater(1.0 - s / (WAKE_LENGTH * radius), 0.0);
    }
    return 1.0 - frame[step_of.solids + 3u] * (1.0 - open);
}
