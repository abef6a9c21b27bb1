// Nearest points on colliders, as spheres that touch the surface; twins of `shape.rs`.

override ELLIPSOID_ROUNDS: u32;

struct Nearest {
    // The touching sphere, and the signed distance to the surface.
    centre: vec3f,
    radius: f32,
    distance: f32,
}

// Offsets of a collider in the frame.
const SHAPE_KIND = 0u;
const SHAPE_ON_HEAD = 1u;
const SHAPE_MIN = 2u;
const SHAPE_MAX = 5u;
const SHAPE_VELOCITY = 8u;
const SHAPE_FORM = 20u;

fn nearest_on_capsule(at: u32, p: vec3f) -> Nearest {
    let a = frame3(at);
    let axis = frame3(at + 3u);
    let q = p - a;
    let along = dot(q, axis) * frame[at + 6u];
    let across = length_of(q - along * axis);
    let t = lesser(greater(along - across * frame[at + 7u], 0.0), 1.0);
    let radius = frame[at + 8u] + t * frame[at + 9u];
    let centre = t * axis;
    return Nearest(centre + a, radius, length_of(q - centre) - radius);
}

/// `along` is the direction in which a push-out may move the point: the touching sphere has the curvature of the surface in it.
fn nearest_on_ellipsoid(at: u32, p: vec3f, along: vec3f) -> Nearest {
    let ax = frame3(at + 3u);
    let ay = frame3(at + 6u);
    let az = frame3(at + 9u);
    let radii = frame3(at + 12u);
    let squared = radii * radii;
    let inv_squared = 1.0 / squared;
    let edge = -0.98 * lesser(squared.x, lesser(squared.y, squared.z));
    let world = p - frame3(at);
    let q = vec3f(dot(world, ax), dot(world, ay), dot(world, az));
    // The nearest point is s = r^2 q / (r^2 + t) with sum (s / r)^2 = 1.
    let bound = abs(q) * radii - squared;
    let least = greater(edge, greater(bound.x, greater(bound.y, bound.z)));
    var t = greater(least, 0.0);
    for (var n = 0u; n < ELLIPSOID_ROUNDS; n++) {
        let g = 1.0 / (squared + t);
        let s = q * g;
        let terms = s * s * squared;
        let value = terms.x + terms.y + terms.z - 1.0;
        let slope = 2.0 * dot(terms, g);
        t = greater(t + value / (slope + 1e-12), least);
    }
    let s = q * squared * (1.0 / (squared + t));
    let gradient = s * inv_squared;
    let steepness = length_of(gradient);
    let normal = gradient * (1.0 / (steepness + 1e-20));
    let distance = dot(q - s, normal);
    // Curvature of the surface in the direction of motion (Euler's formula).
    let d = vec3f(dot(along, ax), dot(along, ay), dot(along, az));
    let tangent = d - normal * dot(d, normal);
    let size = dot(tangent, tangent);
    let sure = size > 1e-8;
    let bend = select(inv_squared.x, dot(tangent * tangent, inv_squared), sure);
    let curvature = bend / (steepness * select(1.0, size, sure) + 1e-20);
    let radius = lesser(1.0 / (curvature + 1e-6), 10.0);
    let c = q - normal * (distance + radius);
    return Nearest(frame3(at) + c.x * ax + c.y * ay + c.z * az, radius, distance);
}

/// The nearest surface of the collider at `at` in the frame.
fn nearest_on(at: u32, p: vec3f, along: vec3f) -> Nearest {
    if frame[at + SHAPE_KIND] == 1.0 {
        return nearest_on_capsule(at + SHAPE_FORM, p);
    }
    return nearest_on_ellipsoid(at + SHAPE_FORM, p, along);
}

/// Where collider `n` is in the frame in this substep.
fn collider_at(n: u32) -> u32 {
    return step_of.shapes + (substep_of.index * step_of.colliders + n) * 35u;
}

/// Whether a box is further than `reach` from that of a collider, or the collider is not usable.
fn is_apart(low: vec3f, high: vec3f, at: u32, reach: f32) -> bool {
    let below = frame3(at + SHAPE_MIN) - high;
    let above = low - frame3(at + SHAPE_MAX);
    return frame[at + SHAPE_KIND] == 0.0 || any(max(below, above) > vec3f(reach));
}
