// The points of fine strands from those of stored ones: twin of `grow_fine` in groom. One thread per point.

struct Grow {
    // Strands, points per strand.
    strands: u32,
    points: u32,
    // How far apart strands look up shadows, metres.
    reach: f32,
    pad: u32,
}

// Twin of `FineStrand`.
struct Strand {
    parent_a: u32,
    parent_b: u32,
    parent_c: u32,
    // Signed bytes in 127ths.
    weights_b: u32,
    weights_c: u32,
    // 16 bits of the length, 8 bits of the shade, and whether the length is one of short hairs.
    length_shade: u32,
}

// Twin of `FineStrand::SHORT_METRES`.
const SHORT_METRES: f32 = 0.1;

@group(0) @binding(0) var<uniform> grow: Grow;
@group(0) @binding(1) var<storage, read> list: array<Strand>;
// The first point of each stored strand, and the number of all points.
@group(0) @binding(2) var<storage, read> first_point: array<u32>;
@group(0) @binding(3) var<storage, read> stored: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> grown: array<vec4f>;
// The places at which shadows are looked up.
@group(0) @binding(5) var<storage, read_write> asked: array<vec4f>;

// See `place` in groom.
fn place_of(strand: u32) -> vec3f {
    var h = strand;
    h = (h ^ (h >> 16u)) * 0x45d9f3bu;
    h = (h ^ (h >> 16u)) * 0x45d9f3bu;
    h = h ^ (h >> 16u);
    return vec3f(vec3u(h, h >> 10u, h >> 20u) & vec3u(0x3ffu)) * (2.0 / 1023.0) - 1.0;
}

fn put(thread: u32, p: vec3f) {
    grown[thread] = vec4f(p, 0.0);
    asked[thread] = vec4f(p + grow.reach * place_of(thread / grow.points), 0.0);
}

// The point of a stored strand at the fraction `j / links` of its points.
fn stored_at(strand: u32, j: u32, links: u32) -> vec3f {
    let first = first_point[strand];
    let own = first_point[strand + 1u] - first - 1u;
    let at = f32(j) / f32(links) * f32(own);
    let i = min(u32(at), own - 1u);
    let low = stored[first + i].xyz;
    let exact = stored[first + min(j, own)].xyz;
    return select(low + (stored[first + i + 1u].xyz - low) * (at - f32(i)), exact, own == links);
}

fn bezier(control: u32, t: f32) -> f32 {
    let w = vec4f(
        f32(extractBits(i32(control), 0u, 8u)),
        f32(extractBits(i32(control), 8u, 8u)),
        f32(extractBits(i32(control), 16u, 8u)),
        f32(extractBits(i32(control), 24u, 8u)),
    ) * (1.0 / 127.0);
    let u = 1.0 - t;
    return u * u * u * w.x + 3.0 * t * u * (u * w.y + t * w.z) + t * t * t * w.w;
}

fn mixed(strand: Strand, j: u32, links: u32) -> vec3f {
    let t = f32(j) / f32(links);
    let a = stored_at(strand.parent_a, j, links);
    let b = stored_at(strand.parent_b, j, links);
    let c = stored_at(strand.parent_c, j, links);
    return a + bezier(strand.weights_b, t) * (b - a) + bezier(strand.weights_c, t) * (c - a);
}

// The length of a strand as a fraction of its first parent's length.
fn length_of(strand: Strand, links: u32) -> f32 {
    let length = f32(strand.length_shade & 0xffffu) * (1.0 / 65535.0);
    if (strand.length_shade >> 24u == 0u) {
        return length;
    }
    var parent = 0.0;
    var before = stored_at(strand.parent_a, 0u, links);
    for (var j = 1u; j <= links; j += 1u) {
        let next = stored_at(strand.parent_a, j, links);
        parent += distance(before, next);
        before = next;
    }
    return min(length * SHORT_METRES / max(parent, 1e-3), 1.0);
}

@compute @workgroup_size(64)
fn grow_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let thread = id.x + id.y * groups.x * 64u;
    if (thread >= grow.strands * grow.points) {
        return;
    }
    let strand = list[thread / grow.points];
    let k = thread % grow.points;
    let links = grow.points - 1u;
    if (strand.parent_a == strand.parent_b && strand.parent_a == strand.parent_c) {
        put(thread, stored_at(strand.parent_a, k, links));
        return;
    }
    let at = f32(k) * length_of(strand, links);
    let i = min(u32(at), links - 1u);
    let low = mixed(strand, i, links);
    put(thread, low + (mixed(strand, i + 1u, links) - low) * (at - f32(i)));
}
