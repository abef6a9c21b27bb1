// The points of the strands, one thread per point: the blended guides of the wisp plus an offset in the moving frame of the wisp.
// Twin of `interpolate` in lovelock-groom; runs after frames.wgsl.

// Twin of `Strand` in mod.rs.
struct Strand {
    weights: vec3f,
    wisp: u32,
}

@group(0) @binding(4) var<storage, read> strands: array<Strand>;
@group(0) @binding(5) var<storage, read> strand_of: array<u32>;
// Offsets along normal, binormal and tangent, and the position along the guides in links, clamped to them.
@group(0) @binding(6) var<storage, read> places: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> points: array<vec4f>;

fn blend(at: CurvePoint, w: vec3f) -> vec3f {
    return (at.a.xyz * w.x + at.b.xyz * w.y) + at.c.xyz * w.z;
}

// Orthonormal normal, binormal and tangent from vectors interpolated between two points of a guide, even where these vanish because
// a guide folds back on itself.
fn orthonormal(tangent_free: vec3f, normal_free: vec3f) -> mat3x3f {
    let squared = dot3(tangent_free, tangent_free);
    let tangent = tangent_free * (1.0 / sqrt(squared));
    let square_normal = normal_free - dot3(normal_free, tangent) * tangent;
    let across = dot3(square_normal, square_normal);
    // False for NaN.
    if (squared > 1e-12 && across > 1e-12) {
        let normal = square_normal * (1.0 / sqrt(across));
        return mat3x3f(normal, cross3(tangent, normal), tangent);
    }
    let along = normalize_or(tangent, vec3f(0.0, 1.0, 0.0));
    let normal = reference_normal(along);
    return mat3x3f(normal, cross3(along, normal), along);
}

fn cross3(a: vec3f, b: vec3f) -> vec3f {
    return vec3f(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

@compute @workgroup_size(64)
fn place_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= instant.strand_points) {
        return;
    }
    let strand = strands[strand_of[i]];
    let place = places[i];
    let links = instant.points_per_guide - 1u;
    let p = min(u32(place.w), links - 1u);
    let t = place.w - f32(p);

    let first = strand.wisp * instant.points_per_guide + p;
    let here = curves[first];
    let next = curves[first + 1u];
    let w = strand.weights;
    let one = blend(here, w);
    let two = blend(next, w);
    var before = 2.0 * one - two;
    if (p > 0u) {
        before = blend(curves[first - 1u], w);
    }
    var after = 2.0 * two - one;
    if (p + 1u < links) {
        after = blend(curves[first + 2u], w);
    }
    let t2 = t * t;
    let t3 = t * t * t;
    let point = before * (-0.5 * t + t2 - 0.5 * t3)
        + one * (1.0 - 2.5 * t2 + 1.5 * t3)
        + two * (0.5 * t + 2.0 * t2 - 1.5 * t3)
        + after * (0.5 * t3 - 0.5 * t2);

    let normal_here = vec3f(here.a.w, here.b.w, here.c.w);
    let normal_next = vec3f(next.a.w, next.b.w, next.c.w);
    let axes = orthonormal(
        here.tangent.xyz + (next.tangent.xyz - here.tangent.xyz) * t,
        normal_here + (normal_next - normal_here) * t,
    );
    let offset = axes[0] * place.x + axes[1] * place.y + axes[2] * place.z;
    points[i] = vec4f(point + offset, 0.0);
}
