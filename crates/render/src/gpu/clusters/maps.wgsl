// Computes what each layer of each column that may be seen lets through and reflects: twin of cpu/clusters/records.rs and of
// `toward_light` in cpu/clusters/columns.rs.

// See `entry_words` in layer.wgsl.
@group(0) @binding(12) var<storage, read_write> maps: array<u32>;
// Per layer of a column, light, and layer that shadows it, for light that comes in and for light that leaves: the optical depth at both
// sections, and the cosine of the light's azimuth there. 0 where no light passes.
@group(0) @binding(14) var<storage, read_write> crossings: array<vec2u>;

// Sine of the angle between eye and hair below which the azimuth of the eye is not defined well: five degrees.
const ALONG_HAIR: f32 = 0.087;
// The most that a half float holds.
const MAX_DEPTH: f32 = 60000.0;

struct Place {
    column: u32,
    layer: u32,
    view: vec4f,
    lights: array<vec4f, 4>,
    // The part of the records toward the eye; the rest is that of their mean over azimuths.
    share: f32,
    mip: f32,
    texels: u32,
    // Optical depth of one strand at both sections.
    depths: vec2f,
}

// As many texels as pixels.
fn mip_of(at: vec4u, layer: u32) -> f32 {
    if (NEAREST) {
        return clusters.finest;
    }
    let share = outward(layer);
    let width = 0.5 * (length(place_on(at.x, share).xy - place_on(at.y, share).xy)
        + length(place_on(at.z, share).xy - place_on(at.w, share).xy));
    let mip = log2(max(f32(FINEST_TEXELS) / max(width, 1e-3), 1.0));
    return clamp(mip, clusters.finest, LAST_MIP);
}

fn depths_of(at: vec4u, layer: u32) -> vec2f {
    return clusters.depth * vec2f(vertices[at.x].inverse_arc, vertices[at.z].inverse_arc) / middle_radius_of(layer);
}

// A cell that is read at `u` of a map, at `inside` of the sector and at `t` along the hair.
struct Spot { sector: Sector, texels: Texels, u: f32, t: f32 }

fn spot_of(place: Place, cell: u32, u: f32, inside: f32, t: f32) -> Spot {
    let sector = sector_of(cell);
    return Spot(sector, texels_of(sector, inside, place.mip), u, t);
}

// Optical depth of a texel with one strand.
fn depth_of(place: Place, spot: Spot) -> f32 {
    var opacity = stored_opacity(spot.sector, bilinear(place.view, spot.u, spot.t), spot.texels);
    if (place.share < 1.0) {
        let any_view = stored_any_view(spot.sector, bilinear(place.lights[0], spot.u, spot.t), spot.texels).x;
        opacity = any_view + (opacity - any_view) * place.share;
    }
    return depth_of_opacity(opacity) / depth_of_bin(spot.sector.index);
}

// Reflectance of a texel under a light.
fn reflectance_of(place: Place, spot: Spot, light: u32) -> f32 {
    let angles = vec2f(bilinear(place.view, spot.u, spot.t), bilinear(place.lights[light], spot.u, spot.t));
    var reflected = stored_reflectance(spot.sector, angles, spot.texels);
    if (place.share < 1.0) {
        let any_view = stored_any_view(spot.sector, angles.y, spot.texels).y;
        reflected = any_view + (reflected - any_view) * place.share;
    }
    return reflected;
}

// The cells of entry `k` of a map at both sections. Equal sectors are one record, swept from section to section.
struct Pair { low: Spot, high: Spot, strands: vec2f }

fn pair_of(place: Place, k: u32) -> Pair {
    let u = (f32(k) - 0.5) / f32(place.texels);
    let side = select(select(1u, 2u, k > place.texels), 0u, k == 0u);
    let inside = u + 1.0 - f32(side);
    let low = cell_of(place.column, place.layer, side, 0u);
    let high = cell_of(place.column, place.layer, side, 1u);
    let swept = ((low ^ high) & 0xffffu) == 0u;
    return Pair(
        spot_of(place, low, u, inside, select(0.0, 0.5, swept)),
        spot_of(place, high, u, inside, select(1.0, 0.5, swept)),
        vec2f(strands_of(low), strands_of(high)),
    );
}

// Optical depths at both sections.
fn depths_of_pair(place: Place, pair: Pair) -> vec2f {
    return pair.strands * vec2f(depth_of(place, pair.low), depth_of(place, pair.high)) * place.depths;
}

// The sector of an average optical depth, as published, and 1 if there is any hair.
fn literal_sector(depth: f32) -> vec2u {
    let bin = clamp(log2(max(depth, 1e-9) / 0.02) / 8.6438562 * f32(DEPTHS - 1u) + 0.5, 0.0, f32(DEPTHS - 1u));
    return vec2u(clusters.pattern * DEPTHS + u32(bin), select(0u, 1u, depth > 0.01));
}

fn wrapped(angle: f32) -> f32 {
    return angle - round(angle / TAU) * TAU;
}

// Sectors, and azimuths of eye and light, of the records at both sections.
struct Published { sectors: array<vec2u, 2>, angles: array<vec2f, 2> }

// The nearest record of the average density under a light, one for both sections where they are alike: `fill_nearest` and
// satf/src/boundary.rs.
fn published(place: Place, light: u32) -> Published {
    let low = vec2f(bilinear(place.view, 0.5, 0.0), bilinear(place.lights[light], 0.5, 0.0));
    let high = vec2f(bilinear(place.view, 0.5, 1.0), bilinear(place.lights[light], 0.5, 1.0));
    let depth_low = strands_of(cell_of(place.column, place.layer, 1u, 0u)) * place.depths.x;
    let depth_high = strands_of(cell_of(place.column, place.layer, 1u, 1u)) * place.depths.y;
    let turn = vec2f(wrapped(low.x - high.x), wrapped(low.y - high.y));
    let parts = vec3f((depth_low - depth_high) / 8.0, 2.0 * turn / TAU);
    if (length(parts) < 0.1) {
        let sector = literal_sector(0.5 * (depth_low + depth_high));
        let middle = vec2f(wrapped(low.x - 0.5 * turn.x), wrapped(low.y - 0.5 * turn.y));
        return Published(array(sector, sector), array(middle, middle));
    }
    return Published(array(literal_sector(depth_low), literal_sector(depth_high)), array(low, high));
}

// The azimuth of the eye is enough for the optical depth.
fn published_depth(sector: vec2u, angle: f32, u: f32, depth: f32) -> f32 {
    let opacity = stored_opacity(Sector(sector.x, 1.0), angle, texels_at(u, 0.0));
    return depth_of_opacity(opacity * f32(sector.y)) * min(depth / 1e-9, 1.0);
}

// Optical depths of entry `k` at both sections.
fn published_depths(place: Place, pair: Published, k: u32) -> vec2f {
    let u = (f32(k) - 0.5) / f32(place.texels);
    return vec2f(
        published_depth(pair.sectors[0], pair.angles[0].x, u, place.depths.x),
        published_depth(pair.sectors[1], pair.angles[1].x, u, place.depths.y),
    );
}

// Reflectances of entry `k` at both sections.
fn published_reflectances(place: Place, pair: Published, k: u32) -> vec2f {
    let texels = texels_at((f32(k) - 0.5) / f32(place.texels), 0.0);
    return vec2f(
        stored_reflectance(Sector(pair.sectors[0].x, 1.0), pair.angles[0], texels),
        stored_reflectance(Sector(pair.sectors[1].x, 1.0), pair.angles[1], texels),
    );
}

fn fill_map(quad: u32, place: Place) {
    let first = map_of(quad);
    var published_pairs: array<Published, 4>;
    if (NEAREST) {
        published_pairs[0] = published(place, 0u);
        for (var light = 1u; light < CLUSTER_LIGHTS; light++) {
            published_pairs[light] = published(place, light);
        }
    }
    var sums = vec4f(0.0);
    for (var k = 0u; k < place.texels + 2u; k++) {
        let entry = first + (1u + k) * entry_words();
        var pair: Pair;
        var depths: vec2f;
        if (NEAREST) {
            depths = published_depths(place, published_pairs[0], k);
        } else {
            pair = pair_of(place, k);
            depths = depths_of_pair(place, pair);
        }
        maps[entry] = pack2x16float(min(depths, vec2f(MAX_DEPTH)));
        for (var light = 0u; light < CLUSTER_LIGHTS; light++) {
            var reflected: vec2f;
            if (NEAREST) {
                reflected = published_reflectances(place, published_pairs[light], k);
            } else {
                reflected = vec2f(reflectance_of(place, pair.low, light), reflectance_of(place, pair.high, light));
            }
            sums[light] += select(0.0, reflected.x + reflected.y, k > 0u && k <= place.texels);
            maps[entry + 1u + light] = pack2x16float(reflected);
        }
    }
    maps[first] = place.texels;
    for (var light = 0u; light < CLUSTER_LIGHTS; light++) {
        let mean = sums[light] / f32(2u * place.texels);
        maps[first + 1u + light] = bitcast<u32>(1.0 / max(mean, 0.02));
    }
}

// Where light passes a layer at `u` of a column: optical depths at both sections.
fn light_depths(place: Place, u: f32) -> vec2f {
    let x = u * f32(place.texels) + 0.5;
    let i = min(u32(select(x, floor(x + 0.5), NEAREST)), place.texels);
    let f = select(x - f32(i), 0.0, NEAREST);
    if (NEAREST) {
        return published_depths(place, published(place, 0u), i);
    }
    let low = depths_of_pair(place, pair_of(place, i));
    return low + (depths_of_pair(place, pair_of(place, i + 1u)) - low) * f;
}

// Writes where a light passes layer `met` on its way to a layer: see `crossings` in satf/src/shadow.rs.
fn cross_layer(slot: u32, column: u32, met: u32, light: u32, position: vec2f) {
    let around = clusters.around;
    let along = clusters.along;
    let turn = atan2(position.y, position.x) / TAU;
    let at = (turn - floor(turn)) * f32(around);
    let first = column / along / around * around;
    let rib = first + u32(at) % around;
    let passed = rib * along + column % along;
    let vertices_of = corners(passed);
    let toward = light_azimuths(vertices_of, light);
    let lights = array(toward, toward, toward, toward);
    let mip = mip_of(vertices_of, met);
    let place = Place(passed, met, toward, lights, 1.0, mip, FINEST_TEXELS >> u32(mip), depths_of(vertices_of, met));
    let u = at - floor(at);
    let depths = light_depths(place, u);
    let cosines = cos(toward.xz) + (cos(toward.yw) - cos(toward.xz)) * u;
    crossings[slot] = vec2u(pack2x16float(min(depths, vec2f(MAX_DEPTH))), pack2x16snorm(cosines));
}

fn fill_crossings(quad: u32, column: u32, layer: u32, light: u32, azimuths: vec4f) {
    let layers = clusters.layers;
    let sector = TAU / f32(clusters.around);
    let here = (f32(column / clusters.along % clusters.around) + 0.5) * sector;
    let toward = here + dot(azimuths, vec4f(0.25));
    let direction = vec2f(cos(toward), sin(toward));
    let radius = radius_of(layer);
    let start = radius * vec2f(cos(here), sin(here));
    let along = dot(start, direction);
    // The distance of the ray from the axis, squared.
    let nearest = radius * radius - along * along;
    for (var k = 0u; k < 2u * layers; k++) {
        let met = k / 2u;
        let enters = (k & 1u) == 0u;
        let outer = radius_of(met);
        // Through the inside: layers within are met twice, that of the point once more.
        let within = along < 0.0 && outer * outer > nearest;
        let is_met = select(within && (met < layer), within || (met > layer), enters);
        let slot = crossings_of(quad, light) + k;
        if (is_met) {
            let half = sqrt(max(outer * outer - nearest, 0.0));
            cross_layer(slot, column, met, light, start + direction * (select(-half, half, enters) - along));
        } else {
            crossings[slot] = vec2u(0u);
        }
    }
}

@compute @workgroup_size(64)
fn fill_maps(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let quad = id.x + id.y * groups.x * 64u;
    if (quad >= quads()) {
        return;
    }
    let column = quad / clusters.layers;
    let layer = quad % clusters.layers;
    let at = corners(column);
    let sines = sines_of(at);
    var low = vec2f(3e38);
    var high = vec2f(-3e38);
    for (var k = 0u; k < 4u; k++) {
        let inner = vertices[at[k]].inner.xy;
        let outer = vertices[at[k]].outer.xy;
        low = min(low, min(inner, outer));
        high = max(high, max(inner, outer));
    }
    // Nobody reads the maps of columns that are not drawn.
    let seen = all(low <= clusters.high) && all(high >= clusters.low) && all(sines >= vec4f(0.0));
    if (!seen) {
        return;
    }
    let lights =
        array(light_azimuths(at, 0u), light_azimuths(at, 1u), light_azimuths(at, 2u), light_azimuths(at, 3u));
    let mip = mip_of(at, layer);
    let share = min(dot(sines, vec4f(0.25)) / ALONG_HAIR, 1.0);
    let place =
        Place(column, layer, view_azimuths(at), lights, share, mip, FINEST_TEXELS >> u32(mip), depths_of(at, layer));
    fill_map(quad, place);
    if (LOCAL_SHADOW == SHADOW_DIRECTIONAL) {
        for (var light = 0u; light < CLUSTER_LIGHTS; light++) {
            fill_crossings(quad, column, layer, light, light_azimuths(at, light));
        }
    }
}
