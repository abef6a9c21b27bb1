// The surface of clusters at their ribs, from `points`: those of each cluster are the inner ring of ribs, then the outer one.

// Where an outer rib crosses a section.
struct Surface {
    here: vec3f,
    next: vec3f,
    // Unit vector toward the tip.
    tangent: vec3f,
    // Unit vector toward the next rib, and outward.
    side: vec3f,
    normal: vec3f,
}

fn unit_or_zero(v: vec3f) -> vec3f {
    let size = length(v);
    return select(vec3f(0.0), v / max(size, 1e-30), size > 1e-30);
}

// Points of a ring of ribs.
fn ring_points() -> u32 {
    return clusters.around * (clusters.along + 1u);
}

// The unit vector toward the tip at point `i` of the rib that begins at point `first`.
fn tangent_at(first: u32, i: u32) -> vec3f {
    return unit_or_zero(points[first + min(i + 1u, clusters.along)].xyz - points[first + max(i, 1u) - 1u].xyz);
}

// At point `at` of the outer ring of the cluster whose first point is `inner`.
fn surface_at(inner: u32, at: u32) -> Surface {
    let around = clusters.around;
    let sections = clusters.along + 1u;
    let rib = at / sections;
    let i = at % sections;
    let outer = inner + ring_points();
    let here = points[outer + at].xyz;
    let next = points[outer + (rib + 1u) % around * sections + i].xyz;
    let across = next - points[outer + (rib + around - 1u) % around * sections + i].xyz;
    let tangent = tangent_at(outer + rib * sections, i);
    let side = unit_or_zero(across - tangent * dot(across, tangent));
    let normal = cross(side, tangent);
    // Outward, also where the guides have turned the wisp inside out.
    let turned = dot(normal, here - points[inner + at].xyz) < 0.0;
    return Surface(here, next, tangent, side, select(normal, -normal, turned));
}
