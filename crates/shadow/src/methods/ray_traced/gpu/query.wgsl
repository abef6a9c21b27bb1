// Rays from a point to the light. Twin of samples.rs, hierarchy.rs and cpu.rs.

@group(0) @binding(4) var<storage, read> ends: array<vec4f>;
@group(0) @binding(5) var<storage, read> nodes: array<vec4f>;

// Lights that stand somewhere are followed here, so points are never projected.
override PROJECTED: bool = false;

// Hits nearer than this are those of the strand that the point belongs to, metres: at least, and as a part of the distance from the anchor.
const NEAREST: f32 = 1e-6;
const NEAREST_PART: f32 = 4e-7;
// The square of the least sine of the angle between a ray and a segment that it sees.
const LEAST_SINE: f32 = 1e-8;
const ENDLESS: f32 = 1e30;
const QUARTER_PI: f32 = 0.785398163;

struct TraceRay {
    origin: vec3f,
    along: vec3f,
    // How far it goes.
    reach: f32,
    // Hits nearer than this do not count.
    nearest: f32,
}

fn ray_of(origin: vec3f, along: vec3f, reach: f32) -> TraceRay {
    return TraceRay(origin, along, reach, max(NEAREST_PART * length(origin), NEAREST));
}

// Whether a ray crosses the box of a node. All axes at once: see `light_of` on loops.
fn crosses(node: u32, ray: TraceRay) -> bool {
    let low = nodes[2u * node].xyz;
    let high = nodes[2u * node + 1u].xyz;
    // An axis along which the ray does not go is no division by 0: it is within the box everywhere or nowhere.
    let is_still = ray.along == vec3f(0.0);
    let inverse = 1.0 / select(ray.along, vec3f(1.0), is_still);
    let a = (low - ray.origin) * inverse;
    let b = (high - ray.origin) * inverse;
    let entry = select(min(a, b), vec3f(0.0), is_still);
    let exit = select(max(a, b), vec3f(ray.reach), is_still);
    let near = max(max(entry.x, entry.y), max(entry.z, 0.0));
    let far = min(min(exit.x, exit.y), min(exit.z, ray.reach));
    let is_beside = is_still & ((ray.origin < low) | (ray.origin > high));
    return near <= far && low.x <= high.x && !any(is_beside);
}

// Whether a ray crosses a ribbon that faces it.
fn hits(at: u32, ray: TraceRay) -> bool {
    let a = ends[2u * at];
    if (a.w == 0.0) {
        return false;
    }
    let first = a.xyz - ray.origin;
    let second = ends[2u * at + 1u].xyz - ray.origin;
    let near = dot(first, ray.along);
    let far = dot(second, ray.along);
    // Across the ray.
    let start = first - ray.along * near;
    let side = second - ray.along * far - start;
    let squared = dot(side, side);
    let whole = second - first;
    if (!(squared > LEAST_SINE * dot(whole, whole))) {
        return false;
    }
    let part = -dot(start, side) / squared;
    let closest = start + side * part;
    let from_start = near + (far - near) * part;
    return part >= 0.0 && part < 1.0 && dot(closest, closest) <= trace.half_width * trace.half_width
        && from_start > ray.nearest && from_start < ray.reach;
}

// Where a ray is in the tree, and how many ribbons it crossed.
struct Walk {
    node: u32,
    count: u32,
}

// Whether a walk ended: behind the last node, or in the dark.
fn is_over(walk: Walk) -> bool {
    return walk.node == 0u || walk.node >= 2u * (trace.places / LEAF) || walk.count >= trace.most;
}

// The next node that is not below this one: up from right children, then to the right.
fn beside(node: u32) -> u32 {
    let up = node >> firstTrailingBit(~node);
    return up + select(1u, 0u, up == 0u);
}

// One node further; stays at a leaf whose box the ray crosses.
fn step_of(walk: Walk, ray: TraceRay) -> Walk {
    if (is_over(walk)) {
        return walk;
    }
    if (!crosses(walk.node, ray)) {
        return Walk(beside(walk.node), walk.count);
    }
    return Walk(select(walk.node, 2u * walk.node, walk.node < trace.places / LEAF), walk.count);
}

// Four nodes further, or past a leaf.
fn stride_of(from_walk: Walk, ray: TraceRay) -> Walk {
    let leaves = trace.places / LEAF;
    let walk = step_of(step_of(step_of(step_of(from_walk, ray), ray), ray), ray);
    if (is_over(walk) || walk.node < leaves || !crosses(walk.node, ray)) {
        return walk;
    }
    let at = (walk.node - leaves) * LEAF;
    let near = select(0u, 1u, hits(at, ray)) + select(0u, 1u, hits(at + 1u, ray));
    let far = select(0u, 1u, hits(at + 2u, ray)) + select(0u, 1u, hits(at + 3u, ray));
    return Walk(beside(walk.node), walk.count + near + far);
}

// The light that the ribbons before the light of a ray let through.
fn light_of(ray: TraceRay) -> f32 {
    var walk = Walk(1u, 0u);
    // Every node is visited at most once. A round makes many steps without loops of its own, because Mesa's software rasteriser ends
    // all loops of a thread after 65,535 rounds together, and the rays that are left would take no light.
    loop {
        if (is_over(walk)) {
            break;
        }
        walk = stride_of(stride_of(stride_of(stride_of(walk, ray), ray), ray), ray);
    }
    return exp_of_minus(trace.each * f32(min(walk.count, trace.most)));
}

// From a square to a disc, both around the origin: areas stay in proportion (Shirley, Chiu 1997).
fn disc(v: vec2f) -> vec2f {
    if (all(v == vec2f(0.0))) {
        return v;
    }
    let is_wide = abs(v.x) > abs(v.y);
    let radius = select(v.y, v.x, is_wide);
    var angle = 0.0;
    if (is_wide) {
        angle = QUARTER_PI * (v.y / v.x);
    } else {
        angle = 2.0 * QUARTER_PI - QUARTER_PI * (v.x / v.y);
    }
    return radius * vec2f(cos(angle), sin(angle));
}

fn hair_transmittance(world_position: vec3f) -> f32 {
    let p = world_position - trace.anchor;
    // False for NaN.
    if (trace.places == 0u || !(dot(abs(p), vec3f(1.0)) < ENDLESS)) {
        return 1.0;
    }
    var toward = trace.light;
    var first_axis = trace.first_axis;
    var second_axis = trace.second_axis;
    let stands = trace.radius >= 0.0;
    if (stands) {
        let way = trace.light - p;
        let from_light = length(way);
        if (!(from_light > trace.radius && from_light < ENDLESS)) {
            return 1.0;
        }
        toward = way / from_light;
        // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
        let side = select(-1.0, 1.0, toward.z >= 0.0);
        let a = -1.0 / (side + toward.z);
        let b = toward.x * toward.y * a;
        first_axis = vec3f(1.0 + side * toward.x * toward.x * a, side * b, -side * toward.x);
        second_axis = vec3f(b, side + toward.y * toward.y * a, -toward.y);
    }
    let width = 2.0 * trace.half_width;
    let edge = f32(trace.edge);
    var sum = 0.0;
    for (var i = 0u; i < trace.edge; i++) {
        for (var j = 0u; j < trace.edge; j++) {
            let start = (vec2f(f32(i), f32(j)) + 0.5) / edge - 0.5;
            let origin = p + width * (start.x * first_axis + start.y * second_axis);
            let cell = vec2f(f32((i + j) % trace.edge), f32((i + 2u * j) % trace.edge));
            let place = disc(2.0 * ((cell + 0.5) / edge) - 1.0);
            let end = trace.spread * (place.x * first_axis + place.y * second_axis);
            if (!stands) {
                sum += light_of(ray_of(origin, normalize(toward + end), ENDLESS));
                continue;
            }
            let target_place = trace.light + end;
            let way = target_place - origin;
            let far = length(way);
            let along = way / far;
            let middle = trace.light - origin;
            let b = dot(middle, along);
            let outside = dot(middle, middle) - trace.radius * trace.radius;
            if (!(outside > 0.0 && far > 0.0)) {
                sum += 1.0;
                continue;
            }
            sum += light_of(ray_of(origin, along, b - sqrt(max(b * b - outside, 0.0))));
        }
    }
    return sum / (edge * edge);
}
