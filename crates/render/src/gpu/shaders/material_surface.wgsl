// The attributes of a body with materials for each sample of a pixel: surface.wgsl with what materials add.

struct Vertex {
    @location(0) position: vec4f,
    // Transmittance of hair toward four lights, 8 bits each.
    @location(1) hair: u32,
    @location(2) normal: vec3f,
    // Linear sRGB; w is 1 where hair grows.
    @location(3) color_scalp: vec4f,
    // Both sets of coordinates.
    @location(4) coordinates: vec4f,
    @location(5) opacity_occlusion: vec2f,
}

struct Seen {
    @builtin(position) position: vec4f,
    // Inside the triangle, even if it covers only a corner of the pixel.
    @location(1) @interpolate(perspective, centroid) normal: vec3f,
    @location(2) @interpolate(perspective, centroid) color_scalp: vec4f,
    @location(3) @interpolate(perspective, centroid) hair: vec4f,
    @location(4) @interpolate(perspective, centroid) coordinates: vec4f,
    @location(5) @interpolate(perspective, centroid) occlusion: f32,
    // At the centre of the pixel, for differences between pixels.
    @location(6) centre_coordinates: vec4f,
    @location(7) centre_opacity: f32,
    @location(8) world: vec3f,
}

@vertex
fn surface(in: Vertex) -> Seen {
    var out: Seen;
    out.position = frame.clip_from_world * vec4f(in.position.xyz, 1.0);
    out.normal = in.normal;
    out.color_scalp = in.color_scalp;
    out.hair = unpack4x8unorm(in.hair);
    out.coordinates = in.coordinates;
    out.occlusion = in.opacity_occlusion.y;
    out.centre_coordinates = in.coordinates;
    out.centre_opacity = in.opacity_occlusion.x;
    out.world = in.position.xyz;
    return out;
}

struct Sample {
    // Octahedral normal and four 8-bit transmittances, all in 16-bit components.
    @location(0) normal_hair: vec4u,
    @location(1) color_scalp: vec4f,
    // Octahedral normal with bumps, index of the material, and occlusion; with a texture of roughness 8 bits of both.
    @location(2) bump_material: vec4u,
    // Colour in shade and emitted light, two components each.
    @location(3) shade_emissive: vec4u,
}

fn flat_normal(normal: vec3f) -> u32 {
    let n = normal / max(abs(normal.x) + abs(normal.y) + abs(normal.z), 1e-9);
    let folded = (1.0 - abs(n.yx)) * select(vec2f(-1.0), vec2f(1.0), n.xy >= vec2f(0.0));
    return pack2x16snorm(select(folded, n.xy, n.z >= 0.0));
}

// Ten bits per component, even in the square root; see `unpack_color` in material_samples.wgsl.
fn pack_color(color: vec3f) -> u32 {
    let q = vec3u(sqrt(clamp(color, vec3f(0.0), vec3f(1.0))) * 1023.0 + 0.5);
    return q.x | (q.y << 10u) | (q.z << 20u);
}

// Nine bits per component with a common exponent; see `unpack_light` in material_samples.wgsl.
fn pack_light(light: vec3f) -> u32 {
    let most = clamp(max(max(light.x, light.y), light.z), 1e-9, 60000.0);
    let exponent = clamp(ceil(log2(most)), -15.0, 16.0);
    let q = vec3u(clamp(light * exp2(-exponent), vec3f(0.0), vec3f(1.0)) * 511.0 + 0.5);
    return q.x | (q.y << 9u) | (q.z << 18u) | (u32(exponent + 15.0) << 27u);
}

// The normal with the bumps of the normal map. Where the columns and rows of the texture go on the triangle follows from how positions
// and coordinates change from pixel to pixel.
fn bumped_normal(normal: vec3f, c: Coordinates, px: vec3f, py: vec3f) -> vec3f {
    let u = direction_on(NORMAL, c.dx);
    let v = direction_on(NORMAL, c.dy);
    let sign = select(-1.0, 1.0, u.x * v.y - u.y * v.x >= 0.0);
    let n = normalize(normal);
    let right = (px * v.y - py * u.y) * sign;
    let down = (py * u.x - px * v.x) * sign;
    let a = right - n * dot(n, right);
    let b = down - n * dot(n, down);
    if (dot(a, a) <= 0.0 || dot(b, b) <= 0.0) {
        return n;
    }
    let texel = look_up(normal_texture, normal_sampler, NORMAL, c).xyz;
    let tilt = (2.0 * texel - 1.0) * vec3f(material.slope, material.slope, 1.0);
    // Normal maps of glTF count upward, rows of an image downward.
    return normalize(a) * tilt.x - normalize(b) * tilt.y + n * tilt.z;
}

fn sample_of(in: Seen, is_front: bool) -> Sample {
    let c = Coordinates(in.coordinates, dpdx(in.centre_coordinates), dpdy(in.centre_coordinates));
    let px = dpdx(in.world);
    let py = dpdy(in.world);
    let side = select(-1.0, 1.0, is_front);
    var base = vec3f(1.0);
    if (is_textured(BASE)) {
        base = look_up(base_texture, base_sampler, BASE, c).rgb;
    }
    var color = in.color_scalp.rgb * material.tint * base;
    var bump = in.normal;
    if (is_textured(NORMAL)) {
        bump = bumped_normal(in.normal, c, px, py);
    }
    var emissive = material.emissive;
    if (is_textured(EMISSIVE)) {
        emissive *= look_up(emissive_texture, emissive_sampler, EMISSIVE, c).rgb;
    }
    var shade = vec3f(0.0);
    if (material.model == 2u) {
        shade = material.shade * material.tint;
        if (is_textured(SHADE)) {
            shade *= look_up(shade_texture, shade_sampler, SHADE, c).rgb;
        }
    }
    if (material.model == 1u) {
        emissive += color;
        color = vec3f(0.0);
    }
    let let_in = clamp(in.occlusion, 0.0, 1.0);
    var occlusion_roughness = u32(let_in * 65535.0 + 0.5);
    if (is_textured(ROUGHNESS)) {
        let roughness = look_up(roughness_texture, roughness_sampler, ROUGHNESS, c).g;
        occlusion_roughness = u32(let_in * 255.0 + 0.5) | (u32(roughness * 255.0 + 0.5) << 8u);
    }
    let hair = pack4x8unorm(in.hair);
    let smooth_normal = flat_normal(in.normal * side);
    let bumps = flat_normal(bump * side);
    let shades = pack_color(shade);
    let light = pack_light(emissive);
    return Sample(
        vec4u(smooth_normal & 0xffffu, smooth_normal >> 16u, hair & 0xffffu, hair >> 16u),
        vec4f(color, in.color_scalp.w),
        vec4u(bumps & 0xffffu, bumps >> 16u, material.index, occlusion_roughness),
        vec4u(shades & 0xffffu, shades >> 16u, light & 0xffffu, light >> 16u),
    );
}

@fragment
fn sample_surface(in: Seen, @builtin(front_facing) is_front: bool) -> Sample {
    return sample_of(in, is_front);
}

// The opacity above which a blended surface is seen in sample `k` of a pixel: see `threshold` in cpu/surface/materials.rs.
fn threshold(pixel: vec2u, k: u32) -> f32 {
    let shift = material.index;
    let x = (pixel.x + shift) & 3u;
    let y = (pixel.y + (shift >> 2u) + shift) & 3u;
    let low = (x ^ y) & 1u;
    let high = ((x ^ y) >> 1u) & 1u;
    let place = (low << 3u) | ((y & 1u) << 2u) | (high << 1u) | (y >> 1u);
    let layer = (k + shift) & 3u;
    return (f32((layer << 4u) | place) + 0.5) / 64.0;
}

// The standard positions of samples, relative to the centre.
const OFFSETS = array<vec2f, 4>(vec2f(-0.125, -0.375), vec2f(0.375, -0.125), vec2f(-0.375, 0.125), vec2f(0.125, 0.375));

// Runs for each sample. Writing the mask of a pixel's samples at once would be less work, but naga declares the mask of SPIR-V as a number
// in place of an array, which drivers may take wrongly (https://github.com/gfx-rs/wgpu/issues/7311).
@fragment
fn sample_with_holes(in: Seen, @builtin(front_facing) is_front: bool, @builtin(sample_index) k: u32) -> Sample {
    let s = sample_of(in, is_front);
    let dx = dpdx(in.centre_coordinates);
    let dy = dpdy(in.centre_coordinates);
    let step = vec2f(dpdx(in.centre_opacity), dpdy(in.centre_opacity));
    let offset = OFFSETS[k & 3u];
    let at = in.centre_coordinates + dx * offset.x + dy * offset.y;
    let own = in.centre_opacity + dot(step, offset);
    if (!is_there(Coordinates(at, dx, dy), own, threshold(vec2u(in.position.xy), k))) {
        discard;
    }
    return s;
}
