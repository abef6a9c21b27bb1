// Computes what each layer of each column that may be seen lets through and reflects: twin of cpu/clusters/records.rs and of
// `toward_light` in cpu/clusters/columns.rs.

// Maps of `clusters.entries` entries: the header, which is one over the mean reflectance and the number of texels; and the texels, with
// one of each neighbour at the ends. A texel is its optical depth at both sections, and its reflectance there, as half floats.
@group(0) @binding(12) var<storage, read_write> maps: array<vec2u>;
// Per layer of a column and layer that shadows it, for light that comes in and for light that leaves: the optical depth at both sections,
// and the cosine of the light's azimuth there. 0 where no light passes.
@group(0) @binding(14) var<storage, read_write> crossings: array<vec2u>;

// Sine of the angle between eye and hair below which the azimuth of the eye is not defined well: five degrees.
const ALONG_HAIR: f32 = 0.087;
// The most that a half float holds.
const MAX_DEPTH: f32 = 60000.0;

struct Place {
    column: u32,
    layer: u32,
    view: vec4f,
    light: vec4f,
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

// Optical depth of a texel with the strands of a cell, and reflectance.
fn read_cell(place: Place, cell: u32, u: f32, inside: f32, t: f32) -> vec2f {
    let sector = sector_of(cell);
    let texels = texels_of(sector, inside, place.mip);
    let angles = vec2f(bilinear(place.view, u, t), bilinear(place.light, u, t));
    var found = stored(sector, angles, texels);
    if (place.share < 1.0) {
        let any_view = stored_any_view(sector, angles.y, texels);
        found = any_view + (found - any_view) * place.share;
    }
    return vec2f(depth_of_opacity(found.x) / depth_of_bin(sector.index), found.y);
}

// Entry `k` of a map: optical depths at both sections, and reflectances.
fn texel_of(place: Place, k: u32) -> vec4f {
    let u = (f32(k) - 0.5) / f32(place.texels);
    let side = select(select(1u, 2u, k > place.texels), 0u, k == 0u);
    let inside = u + 1.0 - f32(side);
    let low = cell_of(place.column, place.layer, side, 0u);
    let high = cell_of(place.column, place.layer, side, 1u);
    // Equal sectors are one record, swept from section to section.
    let swept = ((low ^ high) & 0xffffu) == 0u;
    let at_low = read_cell(place, low, u, inside, select(0.0, 0.5, swept));
    var at_high = at_low;
    if (!swept) {
        at_high = read_cell(place, high, u, inside, 1.0);
    }
    return vec4f(strands_of(low) * at_low.x * place.depths.x, strands_of(high) * at_high.x * place.depths.y, at_low.y, at_high.y);
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

// The nearest record of the average density, one for both sections where they are alike: `fill_nearest` and satf/src/boundary.rs.
fn published(place: Place) -> Published {
    let low = vec2f(bilinear(place.view, 0.5, 0.0), bilinear(place.light, 0.5, 0.0));
    let high = vec2f(bilinear(place.view, 0.5, 1.0), bilinear(place.light, 0.5, 1.0));
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

fn read_published(sector: vec2u, angles: vec2f, u: f32, depth: f32) -> vec2f {
    let found = stored(Sector(sector.x, 1.0), angles, texels_at(u, 0.0));
    return vec2f(depth_of_opacity(found.x * f32(sector.y)) * min(depth / 1e-9, 1.0), found.y);
}

fn published_texel(place: Place, pair: Published, k: u32) -> vec4f {
    let u = (f32(k) - 0.5) / f32(place.texels);
    let low = read_published(pair.sectors[0], pair.angles[0], u, place.depths.x);
    let high = read_published(pair.sectors[1], pair.angles[1], u, place.depths.y);
    return vec4f(low.x, high.x, low.y, high.y);
}

fn fill_map(quad: u32, place: Place) {
    let first = quad * clusters.entries;
    var pair: Published;
    if (NEAREST) {
        pair = published(place);
    }
    var sum = 0.0;
    for (var k = 0u; k < place.texels + 2u; k++) {
        var texel: vec4f;
        if (NEAREST) {
            texel = published_texel(place, pair, k);
        } else {
            texel = texel_of(place, k);
        }
        sum += select(0.0, texel.z + texel.w, k > 0u && k <= place.texels);
        maps[first + 1u + k] = vec2u(pack2x16float(min(texel.xy, vec2f(MAX_DEPTH))), pack2x16float(texel.zw));
    }
    let mean = sum / f32(2u * place.texels);
    maps[first] = vec2u(bitcast<u32>(1.0 / max(mean, 0.02)), place.texels);
}

// Where light passes a layer at `u` of a column: optical depths at both sections.
fn light_depths(place: Place, u: f32) -> vec2f {
    let x = u * f32(place.texels) + 0.5;
    let i = min(u32(select(x, floor(x + 0.5), NEAREST)), place.texels);
    let f = select(x - f32(i), 0.0, NEAREST);
    if (NEAREST) {
        return published_texel(place, published(place), i).xy;
    }
    let low = texel_of(place, i).xy;
    return low + (texel_of(place, i + 1u).xy - low) * f;
}

// Writes where light passes layer `met` on its way to a layer: see `crossings` in satf/src/shadow.rs.
fn cross_layer(slot: u32, column: u32, met: u32, position: vec2f) {
    let around = clusters.around;
    let along = clusters.along;
    let turn = atan2(position.y, position.x) / TAU;
    let at = (turn - floor(turn)) * f32(around);
    let first = column / along / around * around;
    let rib = first + u32(at) % around;
    let passed = rib * along + column % along;
    let vertices_of = corners(passed);
    let light = azimuths_of(vertices_of, 1u);
    let mip = mip_of(vertices_of, met);
    let place = Place(passed, met, light, light, 1.0, mip, FINEST_TEXELS >> u32(mip), depths_of(vertices_of, met));
    let u = at - floor(at);
    let depths = light_depths(place, u);
    let cosines = cos(light.xz) + (cos(light.yw) - cos(light.xz)) * u;
    crossings[slot] = vec2u(pack2x16float(min(depths, vec2f(MAX_DEPTH))), pack2x16snorm(cosines));
}

fn fill_crossings(quad: u32, column: u32, layer: u32, light: vec4f) {
    let layers = clusters.layers;
    let sector = TAU / f32(clusters.around);
    let here = (f32(column / clusters.along % clusters.around) + 0.5) * sector;
    let toward = here + dot(light, vec4f(0.25));
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
        let slot = quad * 2u * layers + k;
        if (is_met) {
            let half = sqrt(max(outer * outer - nearest, 0.0));
            cross_layer(slot, column, met, start + direction * (select(-half, half, enters) - along));
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
    let light = azimuths_of(at, 1u);
    let mip = mip_of(at, layer);
    let share = min(dot(sines, vec4f(0.25)) / ALONG_HAIR, 1.0);
    let place =
        Place(column, layer, azimuths_of(at, 0u), light, share, mip, FINEST_TEXELS >> u32(mip), depths_of(at, layer));
    fill_map(quad, place);
    if (LOCAL_SHADOW == SHADOW_DIRECTIONAL) {
        fill_crossings(quad, column, layer, light);
    }
}
