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

fn unit_or_zero(v: vec3f) -> vec3f {
    let size = length(v);
    return select(vec3f(0.0), v / max(size, 1e-30), size > 1e-30);
}

// The angle of `v` around the strand; 0 where it has none.
fn azimuth(v: vec3f, side: vec3f, normal: vec3f) -> f32 {
    let y = dot(v, side);
    let x = dot(v, normal);
    return select(0.0, atan2(y, x), abs(x) + abs(y) > 0.0);
}

@compute @workgroup_size(64)
fn place_vertices(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let thread = id.x + id.y * groups.x * 64u;
    let around = clusters.grid.x;
    let sections = clusters.grid.y + 1u;
    let ring = around * sections;
    let count = clusters.grid.w * ring;
    if (thread >= count) {
        return;
    }
    let at = thread % ring;
    let rib = at / sections;
    let i = at % sections;
    let inner = (thread - at) * 2u;
    let outer = inner + ring;
    let here = points[outer + at].xyz;
    let next = points[outer + (rib + 1u) % around * sections + i].xyz;
    let across = next - points[outer + (rib + around - 1u) % around * sections + i].xyz;
    let first = outer + rib * sections;
    let along = points[first + min(i + 1u, sections - 1u)].xyz - points[first + max(i, 1u) - 1u].xyz;
    let tangent = unit_or_zero(along);
    let side = unit_or_zero(across - tangent * dot(across, tangent));
    // Outward, also where the guides have turned the wisp inside out.
    var normal = cross(side, tangent);
    normal *= select(1.0, -1.0, dot(normal, here - points[inner + at].xyz) < 0.0);
    let to_eye = unit_or_zero(clusters.eye_depth.xyz - here);
    let a = shaded[inner + at];
    let b = shaded[outer + at];
    let drawn = a.half_width >= 0.0 && b.half_width >= 0.0 && any(normal != vec3f(0.0));
    let view = azimuth(to_eye, side, normal);
    vertices[thread] = ClusterVertex(
        a.at,
        select(-1.0, length(cross(to_eye, tangent)), drawn),
        b.at,
        1.0 / max(length(cross(next - here, tangent)), 1e-6),
        vec2f(view, azimuth(clusters.light_detail.xyz, side, normal)),
        cos(view),
        a.color,
        b.color,
    );
}
