// From four power moments to the share of hair before a depth. Twin of solve.rs.

// The even distribution that is mixed in.
const EVEN: vec4f = vec4f(0.0, 0.375, 0.0, 0.375);

// The least variance and pivot with which the system counts as solvable.
const LEAST_PIVOT: f32 = 1e-12;

// Biased moments and the Cholesky factors of their Hankel matrix.
struct System {
    moments: vec4f,
    // The entry of L below its diagonal that is no moment.
    low: f32,
    // The second and third entry of D.
    pivots: vec2f,
}

fn system_of(moments: vec4f) -> System {
    let b = moments + (EVEN - moments) * texels.bias;
    let variance = b.y - b.x * b.x;
    let covariance = b.z - b.x * b.y;
    let low = covariance / variance;
    let last = (b.w - b.y * b.y) - covariance * low;
    return System(b, low, vec2f(variance, last));
}

// Whether the matrix is positive definite. False for NaN.
fn is_solvable(system: System) -> bool {
    return system.pivots.x > LEAST_PIVOT && system.pivots.y > LEAST_PIVOT;
}

// The share of hair before `z`. Only of a solvable system.
fn share_before(system: System, z: f32) -> f32 {
    let b = system.moments;
    let second = z - b.x;
    let third = (z * z - b.y - system.low * second) / system.pivots.y;
    let c1 = second / system.pivots.x - system.low * third;
    let c0 = 1.0 - (c1 * b.x + third * b.y);
    let p = c1 / third;
    let q = c0 / third;
    let square = p * p * 0.25 - q;
    let root = sqrt(select(0.0, square, square > 0.0));
    let near = -0.5 * p - root;
    let far = -0.5 * p + root;
    let f0 = texels.overestimation;
    let f1 = select(0.0, 1.0, near < z);
    let f2 = select(0.0, 1.0, far < z);
    let f01 = (f1 - f0) / (near - z);
    let f12 = (f2 - f1) / (far - near);
    let f012 = (f12 - f01) / (far - z);
    let linear = f01 - f012 * near;
    let constant = f0 - linear * z;
    var share = constant + (linear - f012 * z) * b.x + f012 * b.y;
    // NaN, where roots coincide, becomes 0.
    share = select(0.0, share, share > 0.0);
    return select(1.0, share, share < 1.0);
}
