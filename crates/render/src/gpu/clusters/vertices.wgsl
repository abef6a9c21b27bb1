// Computes the vertices of all clusters, in the order of cluster, rib and section. Twin of cpu/clusters/vertices.rs.

struct ShadedPoint {
    at: vec3f,
    half_width: f32,
    across: vec2f,
    color: vec2u,
}

// Points of the ribs of each cluster: the inner ring, then the outer one.
@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(2) var<storage, read> shaded: array<ShadedPoint>;
@group(0) @binding(11) var<storage, read_write> vertices: array<ClusterVertex>;
// The parts of the light of each point: see rib_light.wgsl.
@group(0) @binding(24) var<storage, read> rib_light: array<vec2u>;

// The angle of `v` around the strand; 0 where it has none.
fn azimuth(v: vec3f, surface: Surface) -> f32 {
    let y = dot(v, surface.side);
    let x = dot(v, surface.normal);
    return select(0.0, atan2(y, x), abs(x) + abs(y) > 0.0);
}

@compute @workgroup_size(64)
fn place_vertices(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let thread = id.x + id.y * groups.x * 64u;
    let ring = ring_points();
    if (thread >= clusters.count * ring) {
        return;
    }
    let at = thread % ring;
    let inner = (thread - at) * 2u;
    let surface = surface_at(inner, at);
    let to_eye = unit_or_zero(clusters.eye - surface.here);
    let a = shaded[inner + at];
    let b = shaded[inner + ring + at];
    let drawn = a.half_width >= 0.0 && b.half_width >= 0.0 && any(surface.normal != vec3f(0.0));
    let view = azimuth(to_eye, surface);
    var lights: vec4f;
    for (var k = 0u; k < 4u; k++) {
        lights[k] = azimuth(clusters.to_lights[k].xyz, surface);
    }
    var lit: array<vec4u, LIT_PARTS>;
    for (var part = 0u; part < LIT_PARTS; part++) {
        lit[part] = vec4u(
            rib_light[(inner + at) * LIT_PARTS + part],
            rib_light[(inner + ring + at) * LIT_PARTS + part],
        );
    }
    vertices[thread] = ClusterVertex(
        a.at,
        select(-1.0, length(cross(to_eye, surface.tangent)), drawn),
        b.at,
        1.0 / max(length(cross(surface.next - surface.here, surface.tangent)), 1e-6),
        lights,
        view,
        cos(view),
        lit,
    );
}
