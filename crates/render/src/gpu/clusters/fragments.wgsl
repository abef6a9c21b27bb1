// Rasterises the layers of clusters as triangles, and shades their pixels. Twin of cpu/clusters/columns.rs and pixels.rs. A pass defines
// `take(pixel, fragment)`.
//
// Several threads share a triangle that may cover very many pixels, because software adapters end loops after 65,535 iterations.

@group(0) @binding(12) var<storage, read> maps: array<u32>;
@group(0) @binding(14) var<storage, read> crossings: array<vec2u>;

// Whether each map is read at its nearest texel.
override NEAREST: bool = false;
// Whether hair shell volumes are coloured by their records.
override SHOWS_RECORDS: bool = false;

// Fragments of a smaller opacity are left out.
const FAINTEST: f32 = 1.0 / 1024.0;
// The optical depth of an opaque layer.
const OPAQUE_DEPTH: f32 = 13.8155106;
const SAMPLES_X: vec4f = vec4f(0.375, 0.875, 0.125, 0.625);
const SAMPLES_Y: vec4f = vec4f(0.125, 0.375, 0.625, 0.875);

// The barycentric coordinate of the corner beside an edge: `x * px + y * py + c`.
fn edge_of(p: vec2f, q: vec2f, area: f32) -> vec3f {
    let slope = vec2f(p.y - q.y, q.x - p.x) / area;
    return vec3f(slope, -dot(slope, p));
}

// The columns of a row of which the edges of a triangle leave a part inside, as lines over rows: slopes and offsets of three lower bounds
// and of three upper ones.
struct Span { low_slopes: vec3f, low: vec3f, high_slopes: vec3f, high: vec3f }

const UNBOUNDED: f32 = 1e9;

fn span_of(edge_a: vec3f, edge_b: vec3f, edge_c: vec3f) -> Span {
    let x = vec3f(edge_a.x, edge_b.x, edge_c.x);
    let y = vec3f(edge_a.y, edge_b.y, edge_c.y);
    let inverse = -1.0 / select(x, vec3f(1.0), abs(x) < vec3f(1e-12));
    let slopes = y * inverse;
    // An edge is tested at the end of the row where it leaves more inside.
    let at_zero = (vec3f(edge_a.z, edge_b.z, edge_c.z) + max(y, vec3f(0.0))) * inverse;
    let is_low = x >= vec3f(1e-12);
    let is_high = x <= vec3f(-1e-12);
    return Span(
        select(vec3f(0.0), slopes, is_low),
        select(vec3f(-UNBOUNDED), at_zero - 1.0, is_low),
        select(vec3f(0.0), slopes, is_high),
        select(vec3f(UNBOUNDED), at_zero, is_high),
    );
}

// Where a map is read: the first words of two texels, and where between them.
struct MapPlace { low: u32, high: u32, f: f32 }

fn map_place(quad: u32, texels: u32, u: f32) -> MapPlace {
    let x = u * f32(texels) + 0.5;
    let i = min(u32(select(x, floor(x + 0.5), NEAREST)), texels);
    let low = map_of(quad) + (1u + i) * entry_words();
    return MapPlace(low, low + entry_words(), select(x - f32(i), 0.0, NEAREST));
}

// A value of a map between both sections: its optical depth before the curve of the layer (0), or its reflectance under a light (1 and on).
fn map_value(at: MapPlace, value: u32, t: f32) -> f32 {
    let low = unpack2x16float(maps[at.low + value]);
    let both = low + (unpack2x16float(maps[at.high + value]) - low) * at.f;
    return between(both.x, both.y, t);
}

// The fraction of a light that other layers let through to a place on a layer (Xu et al., equation 12). Only where light passes elsewhere
// than where the eye sees the place does it depend on the light.
fn own_shadow(quad: u32, layer: u32, light: u32, u: f32, t: f32, at: vec4u) -> f32 {
    let layers = clusters.layers;
    let strength = clusters.shadow_strength;
    let sums_opacities = LOCAL_SHADOW == SHADOW_LINEAR || LOCAL_SHADOW == SHADOW_EXPONENTIAL;
    var sum = 0.0;
    if (LOCAL_SHADOW == SHADOW_OF_LAYERS || sums_opacities) {
        let cos_view = bilinear(cosines_of(at), u, t);
        for (var outer = layer + 1u; outer < layers; outer++) {
            let above = quad + outer - layer;
            let depth = map_value(map_place(above, maps[map_of(above)], u), 0u, t) * curved(cos_view, thickness_of(outer));
            sum += select(min(depth, OPAQUE_DEPTH), 1.0 - exp(-depth), sums_opacities);
        }
    }
    if (LOCAL_SHADOW == SHADOW_DIRECTIONAL) {
        let first = crossings_of(quad, light);
        for (var k = 0u; k < 2u * layers; k++) {
            let crossing = crossings[first + k];
            let depths = unpack2x16float(crossing.x);
            let cosines = unpack2x16snorm(crossing.y);
            let depth = between(depths.x, depths.y, t) * curved(between(cosines.x, cosines.y, t), thickness_of(k / 2u));
            sum += min(depth, OPAQUE_DEPTH);
        }
    }
    if (LOCAL_SHADOW == SHADOW_LINEAR) {
        return max(1.0 - strength * sum, 0.0);
    }
    return exp(-strength * sum);
}

// A part of the light at a vertex on the surface of a layer.
fn lit_on(vertex: u32, part: u32, share: f32) -> vec3f {
    let lit = vertices[vertex].lit[part];
    let a = vec3f(unpack2x16float(lit.x), unpack2x16float(lit.y).x);
    let b = vec3f(unpack2x16float(lit.z), unpack2x16float(lit.w).x);
    return a + (b - a) * share;
}

// A part of the light at the corners of a layer.
struct CornerLight { a: vec3f, b: vec3f, c: vec3f, d: vec3f }

fn corner_light(at: vec4u, part: u32, share: f32) -> CornerLight {
    return CornerLight(
        lit_on(at.x, part, share),
        lit_on(at.y, part, share),
        lit_on(at.z, part, share),
        lit_on(at.w, part, share),
    );
}

fn light_between(corners: CornerLight, u: f32, t: f32) -> vec3f {
    let lower = corners.a + (corners.b - corners.a) * u;
    let upper = corners.c + (corners.d - corners.c) * u;
    return lower + (upper - lower) * t;
}

// A colour for a record: hues for patterns, brighter for denser ones.
fn record_color(cell: u32) -> vec3f {
    let index = cell & 0x7fffu;
    let hue = f32(index / 16u) * 0.618034;
    let bright = 0.15 + 0.85 * f32(index % 16u) / 15.0;
    return bright * (0.5 + 0.5 * cos(fract(hue + vec3f(0.0, 1.0, 2.0) / 3.0) * TAU));
}

@compute @workgroup_size(64)
fn each_fragment(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let thread = id.x + id.y * groups.x * 64u;
    let triangle = thread / clusters.lanes;
    let quad = triangle / 2u;
    if (quad >= quads()) {
        return;
    }
    let layers = clusters.layers;
    let column = quad / layers;
    let layer = quad % layers;
    let at = corners(column);
    if (!all(sines_of(at) >= vec4f(0.0))) {
        return;
    }
    let share = outward(layer);
    let corner_a = place_on(at.x, share);
    let corner_b = place_on(at.y, share);
    let corner_c = place_on(at.z, share);
    let corner_d = place_on(at.w, share);
    // Two triangles share the diagonal from the first corner to the last one.
    let is_second = (triangle & 1u) == 1u;
    let p = corner_a;
    let q = select(corner_b, corner_d, is_second);
    let r = select(corner_d, corner_c, is_second);
    // Relative to the pixel of a corner, so that products of coordinates are exact enough.
    let origin = floor(min(p.xy, min(q.xy, r.xy)));
    let a = p.xy - origin;
    let b = q.xy - origin;
    let c = r.xy - origin;
    let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (!(abs(area) > 0.0 && abs(area) < 1e30)) {
        return;
    }
    let first_pixel = vec2f(eye.corner) - origin;
    // Whole pixels: the last one of the area begins at its edge less one.
    let low = max(floor(min(a, min(b, c))), first_pixel);
    let high = min(max(a, max(b, c)), first_pixel + vec2f(eye.size) - 1.0);
    if (!(low.x <= high.x && low.y <= high.y)) {
        return;
    }
    let edge_a = edge_of(b, c, area);
    let edge_b = edge_of(c, a, area);
    let edge_c = edge_of(a, b, area);
    let span = span_of(edge_a, edge_b, edge_c);
    let u_of = select(vec3f(0.0, 1.0, 1.0), vec3f(0.0, 1.0, 0.0), is_second);
    let t_of = select(vec3f(0.0, 0.0, 1.0), vec3f(0.0, 1.0, 1.0), is_second);
    let depth_of = vec3f(p.z, q.z, r.z);
    let cosines = cosines_of(at);
    let thickness = thickness_of(layer);
    var lit: array<CornerLight, LIT_PARTS>;
    lit[0] = corner_light(at, 0u, share);
    let header = map_of(quad);
    let texels = maps[header];
    let detail = clusters.detail;
    let as_published = clusters.as_published != 0u;
    var slopes: vec4f;
    for (var light = 0u; light < CLUSTER_LIGHTS; light++) {
        lit[1u + light] = corner_light(at, 1u + light, share);
        slopes[light] = select(detail * bitcast<f32>(maps[header + 1u + light]), 1.0, as_published);
    }
    let even = select(1.0 - detail, 0.0, as_published);
    let hash = fract(f32(quad) * 0.618034);
    let middle_distance = 4.0 / max(corner_a.z + corner_b.z + corner_c.z + corner_d.z, 1e-9);

    // One loop over rows and columns: on software adapters each inner loop would cost an empty iteration.
    let bottom = i32(high.y);
    let lanes = i32(clusters.lanes);
    var row = i32(low.y) + i32(thread % clusters.lanes) - lanes;
    var x = 0;
    var last = -1;
    loop {
        x++;
        if (x > last) {
            row += lanes;
            if (row > bottom) {
                break;
            }
            let y = f32(row);
            let lows = span.low_slopes * y + span.low;
            let highs = span.high_slopes * y + span.high;
            let left = max(max(lows.x, lows.y), max(lows.z, low.x));
            let right = min(min(highs.x, highs.y), min(highs.z, high.x));
            x = i32(left);
            last = select(-1, i32(right), left <= right);
        }
        if (x <= last) {
            let corner = vec2f(f32(x), f32(row));
            let weights = vec3f(
                dot(edge_a.xy, corner) + edge_a.z,
                dot(edge_b.xy, corner) + edge_b.z,
                dot(edge_c.xy, corner) + edge_c.z,
            );
            let inside = (weights.x + edge_a.x * SAMPLES_X + edge_a.y * SAMPLES_Y >= vec4f(0.0))
                & (weights.y + edge_b.x * SAMPLES_X + edge_b.y * SAMPLES_Y >= vec4f(0.0))
                & (weights.z + edge_c.x * SAMPLES_X + edge_c.y * SAMPLES_Y >= vec4f(0.0));
            if (!any(inside)) {
                continue;
            }
            let half_steps = 0.5 * vec3f(edge_a.x + edge_a.y, edge_b.x + edge_b.y, edge_c.x + edge_c.y);
            var middle = max(weights + half_steps, vec3f(0.0));
            middle /= middle.x + middle.y + middle.z;
            let depth = dot(middle, depth_of);
            let pixel = vec2u(vec2i(i32(origin.x) + x, i32(origin.y) + row));
            let place = pixel - eye.corner;
            let seen = inside & (vec4f(depth) >= textureLoad(depths, place, 0));
            if (!any(seen)) {
                continue;
            }
            let u = clamp(dot(middle, u_of), 0.0, 1.0);
            let t = clamp(dot(middle, t_of), 0.0, 1.0);
            let cos_view = bilinear(cosines, u, t);
            let found = map_place(quad, texels, u);
            let alpha = 1.0 - exp(-map_value(found, 0u, t) * curved(cos_view, thickness));
            if (!(alpha >= FAINTEST)) {
                continue;
            }
            var color: vec3f;
            if (SHOWS_RECORDS) {
                color = record_color(cell_of(column, layer, 1u, select(0u, 1u, t > 0.5)));
            } else {
                // Ambient light, which no record reflects and no layer shadows, and what records reflect of each light.
                color = light_between(lit[0], u, t);
                var through = 1.0;
                for (var light = 0u; light < CLUSTER_LIGHTS; light++) {
                    if (light == 0u || LOCAL_SHADOW == SHADOW_DIRECTIONAL) {
                        through = own_shadow(quad, layer, light, u, t, at);
                    }
                    let gain = max(even + slopes[light] * map_value(found, 1u + light, t), 0.0);
                    color += light_between(lit[1u + light], u, t) * (gain * through);
                }
            }
            take(place.y * eye.size.x + place.x, Fragment(depth, alpha, seen, color, hash, middle_distance, pixel));
        }
    }
}
