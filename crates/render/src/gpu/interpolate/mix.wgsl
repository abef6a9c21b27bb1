// Guides between two steps, one thread per guide. Twin of `mix_guides` in lovelock-record: points move in straight lines in the space of the
// head, and the length of each link lies between its lengths in both steps.

// Twin of `Mix` in mod.rs.
struct Mix {
    // The head in the step before, in the next one, and between them: columns of the rotation, and the place.
    heads: array<mat4x4f, 3>,
    t: f32,
    points_per_guide: u32,
    guide_points: u32,
}

@group(0) @binding(0) var<uniform> mix_of: Mix;
// All x, then all y, then all z.
@group(0) @binding(1) var<storage, read> before: array<f32>;
@group(0) @binding(2) var<storage, read> now: array<f32>;
@group(0) @binding(3) var<storage, read_write> mixed: array<f32>;

fn to_head(head: u32, world: vec3f) -> vec3f {
    let away = world - mix_of.heads[head][3].xyz;
    return vec3f(
        dot(mix_of.heads[head][0].xyz, away),
        dot(mix_of.heads[head][1].xyz, away),
        dot(mix_of.heads[head][2].xyz, away),
    );
}

@compute @workgroup_size(64)
fn mix_guides(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let first = (id.x + id.y * groups.x * 64u) * mix_of.points_per_guide;
    let n = mix_of.guide_points;
    if (first >= n) {
        return;
    }
    let t = mix_of.t;
    var last_p = vec3f(0.0);
    var last_q = vec3f(0.0);
    var last = vec3f(0.0);
    for (var point = 0u; point < mix_of.points_per_guide; point++) {
        let i = first + point;
        let p = to_head(0u, vec3f(before[i], before[n + i], before[2u * n + i]));
        let q = to_head(1u, vec3f(now[i], now[n + i], now[2u * n + i]));
        let middle = p + (q - p) * t;
        var here = middle;
        if (point > 0u) {
            let length_p = distance(p, last_p);
            let wanted = length_p + (distance(q, last_q) - length_p) * t;
            let link = middle - (last_p + (last_q - last_p) * t);
            let found = length(link);
            here = last;
            // False for NaN.
            if (found > 0.0) {
                here = last + link * (wanted / found);
            }
        }
        last_p = p;
        last_q = q;
        last = here;
        let head = mix_of.heads[2];
        let world = head[0].xyz * here.x + head[1].xyz * here.y + head[2].xyz * here.z + head[3].xyz;
        mixed[i] = world.x;
        mixed[n + i] = world.y;
        mixed[2u * n + i] = world.z;
    }
}
