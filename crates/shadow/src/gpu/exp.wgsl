// The exponentials of exp.rs, operation by operation.

// e^(-depth / 4096) for 0 <= depth <= 262144, exactly 1 at 0.
fn exp_of_minus_steps(depth: f32) -> f32 {
    let octaves = depth * (1.44269504088896340736 / 4096.0);
    let whole = i32(octaves);
    let g = octaves - f32(whole);
    var p = -9.449037e-4;
    p = p * g + 9.205799e-3;
    p = p * g - 5.529736e-2;
    p = p * g + 0.24018015;
    p = p * g - 0.6931437;
    p = p * g + 1.0;
    return bitcast<f32>(bitcast<i32>(p) - (whole << 23u));
}

// e^(-depth); 1 at 0 and for NaN.
fn exp_of_minus(depth: f32) -> f32 {
    var steps = select(0.0, depth, depth > 0.0);
    steps = select(64.0, steps, steps < 64.0) * 4096.0;
    let t = exp_of_minus_steps(steps);
    return select(1.0, t, t < 1.0);
}
