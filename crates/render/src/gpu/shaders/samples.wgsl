// The samples of a body in a pixel: those that lie on the same smooth part of it are shaded once. What a material adds is `More`, which
// surface_samples.wgsl and material_samples.wgsl define.

// The body in one sample.
struct Seen {
    normal: vec3f,
    depth: f32,
    color_scalp: vec4f,
    hair: vec4f,
    more: More,
}

// The normal of two components of an octahedron.
fn unfolded(x: u32, y: u32) -> vec3f {
    let folded = unpack2x16snorm(x | (y << 16u));
    let z = 1.0 - abs(folded.x) - abs(folded.y);
    let turned = (1.0 - abs(folded.yx)) * select(vec2f(-1.0), vec2f(1.0), folded >= vec2f(0.0));
    return normalize(vec3f(select(turned, folded, z >= 0.0), z));
}

fn sample_at(pixel: vec2u, k: i32, depth: f32) -> Seen {
    let words = textureLoad(normals, pixel, k);
    let hair = unpack4x8unorm(words.z | (words.w << 16u));
    return Seen(unfolded(words.x, words.y), depth, textureLoad(colors, pixel, k), hair, more_at(pixel, k));
}

// Whether two samples lie on the same smooth part of the body, so that they can be shaded as one.
fn belong_together(a: Seen, b: Seen) -> bool {
    return are_alike(a.more, b.more) && dot(a.normal, b.normal) > 0.9 && abs(a.depth - b.depth) <= 0.01 * a.depth
        && all(abs(a.color_scalp - b.color_scalp) < vec4f(0.1));
}

// One of four, without an array: indexed arrays are slow on software adapters.
fn chosen(a: Seen, b: Seen, c: Seen, d: Seen, k: u32) -> Seen {
    var one = a;
    if (k == 1u) {
        one = b;
    } else if (k == 2u) {
        one = c;
    } else if (k == 3u) {
        one = d;
    }
    return one;
}

// Samples that are shaded together, and their number.
struct Group {
    sum: Seen,
    count: f32,
}

fn join(group: Group, other: Seen, joins: bool) -> Group {
    var joined = group;
    if (joins) {
        joined.sum.normal += other.normal;
        joined.sum.depth += other.depth;
        joined.sum.color_scalp += other.color_scalp;
        joined.sum.hair += other.hair;
        joined.sum.more = added(joined.sum.more, other.more);
        joined.count += 1.0;
    }
    return joined;
}
