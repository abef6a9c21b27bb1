// Sine and cosine with the same results on every device. Twin of turn.rs.

// The sine of a quarter of a turn before and behind 0, in turns.
fn quarter_sine(x: f32) -> f32 {
    let square = x * x;
    var p = -15.094643;
    p = p * square + 42.058693;
    p = p * square - 76.70586;
    p = p * square + 81.60525;
    p = p * square - 41.341702;
    p = p * square + 6.2831853;
    return p * x;
}

// The sine of `x` turns, −1 to 2.
fn sine(x: f32) -> f32 {
    let part = x - floor(x + 0.5);
    let folded = select(part, 0.5 - part, part > 0.25);
    return quarter_sine(select(folded, -0.5 - folded, folded < -0.25));
}

// Cosine and sine of `x` turns, −1 to 1.
fn turn(x: f32) -> vec2f {
    return vec2f(sine(x + 0.25), sine(x));
}

// Cosine and sine of the sum of two angles.
fn turn_on(a: vec2f, by: vec2f) -> vec2f {
    return vec2f(a.x * by.x - a.y * by.y, a.y * by.x + a.x * by.y);
}
