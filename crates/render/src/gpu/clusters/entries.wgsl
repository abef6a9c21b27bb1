// Moves the points of ribs toward a light, to where it enters their cluster: the ellipse of their section. Twin of
// cpu/clusters/entries.rs.

@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> entries: array<vec4f>;

// The most that a point is moved, metres: light along the hair would go a long way in it.
const MAX_WAY: f32 = 0.1;

fn turned_by(rib: u32) -> vec2f {
    let angle = TAU * f32(rib) / f32(clusters.around);
    return vec2f(cos(angle), sin(angle));
}

// How far it is to the surface from rib `rib` at `radius` of section `i`, metres.
fn way_out(outer: u32, i: u32, rib: u32, radius: f32) -> f32 {
    let around = clusters.around;
    let toward = clusters.to_lights[clusters.light].xyz;
    // The axes of the ellipse to which the disk's axes are mapped.
    var x = vec3f(0.0);
    var y = vec3f(0.0);
    for (var k = 0u; k < around; k++) {
        let rim = points[outer + k * (clusters.along + 1u) + i].xyz * (2.0 / f32(around));
        let angle = turned_by(k);
        x += rim * angle.x;
        y += rim * angle.y;
    }
    // The direction in the disk, by least squares: what is along the hair leaves the place in the disk as it is.
    let xx = dot(x, x);
    let xy = dot(x, y);
    let yy = dot(y, y);
    let determinant = xx * yy - xy * xy;
    let d = vec2f(yy * dot(x, toward) - xy * dot(y, toward), xx * dot(y, toward) - xy * dot(x, toward)) / determinant;
    // |place + way d| = 1.
    let a = dot(d, d);
    let b = dot(turned_by(rib) * radius, d);
    let c = radius * radius - 1.0;
    let way = (sqrt(max(b * b - a * c, 0.0)) - b) / a;
    // A section without an area gives NaN or infinity.
    return select(0.0, min(way, MAX_WAY), way > 0.0 && abs(determinant) > 0.0);
}

@compute @workgroup_size(64)
fn place_entries(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let thread = id.x + id.y * groups.x * 64u;
    let around = clusters.around;
    let sections = clusters.along + 1u;
    let ring = around * sections;
    if (thread >= clusters.count * 2u * ring) {
        return;
    }
    let k = thread % (2u * ring);
    let rib = k / sections;
    let radius = select(1.0, clusters.core, rib < around);
    let way = way_out(thread - k + ring, k % sections, rib % around, radius);
    entries[thread] = vec4f(points[thread].xyz + clusters.to_lights[clusters.light].xyz * way, 0.0);
}
