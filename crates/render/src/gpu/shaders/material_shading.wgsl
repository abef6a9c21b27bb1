// Shading of a body with materials: the twin of cpu/surface/material_shading.rs and reflectance.rs.

struct Surface {
    world: vec3f,
    normal: vec3f,
    // The normal with the bumps of the normal map.
    bump: vec3f,
    // Linear sRGB; w is 1 where hair grows.
    color_scalp: vec4f,
    // Transmittance of hair toward four lights.
    hair: vec4f,
    occlusion: f32,
    shade: vec3f,
    emissive: vec3f,
    material: u32,
    // Multiplies the roughness of the material.
    roughness: f32,
}

// Twin of `SurfaceMaterial` in surface_material.rs.
struct SurfaceMaterial {
    tint: vec3f,
    model: u32,
    spread: vec3f,
    reflectance: f32,
    roughness: vec2f,
    second: f32,
    rim: f32,
    shift: f32,
    toony: f32,
    rim_lift: f32,
    rim_lit: f32,
    rim_color: vec3f,
    rim_power: f32,
    is_rough_by_texture: u32,
}

@group(0) @binding(26) var<storage, read> materials: array<SurfaceMaterial>;

// A position to shade: its normal without and with bumps, the unit vector toward the eye, its colours, the cosine of the eye, the share of
// light that highlights reflect, and what part of it has highlights.
struct Place {
    world: vec3f,
    n: vec3f,
    b: vec3f,
    v: vec3f,
    albedo: vec3f,
    shade: vec3f,
    nv: f32,
    glossy: f32,
    bare: f32,
}

// Twin of the constant in surface_material.rs.
const LEAST_ROUGHNESS: f32 = 0.08;

fn spread_cosine(cosine: f32, by: vec3f) -> vec3f {
    let width = max(by, vec3f(1e-3));
    let within = clamp(cosine + width, vec3f(0.0), 2.0 * width);
    let beyond = max(cosine - width, vec3f(0.0));
    return (within * within / (4.0 * width) + beyond) / (1.0 + width * width / 3.0);
}

fn lobe(nh: f32, nl: f32, nv: f32, roughness: f32) -> f32 {
    let alpha = roughness * roughness;
    let a2 = alpha * alpha;
    let d = nh * nh * (a2 - 1.0) + 1.0;
    let distribution = a2 * 0.318309886 / max(d * d, 1e-9);
    return distribution * 0.5 / max(mix(2.0 * nl * nv, nl + nv, alpha), 1e-4);
}

fn fresnel(reflectance: f32, lh: f32) -> f32 {
    let grazing = 1.0 - clamp(lh, 0.0, 1.0);
    let square = grazing * grazing;
    return reflectance + (1.0 - reflectance) * square * square * grazing;
}

fn reflected_share(nv: f32, roughness: f32, reflectance: f32) -> f32 {
    let grazing = 1.0 - clamp(nv, 0.0, 1.0);
    let square = grazing * grazing;
    let lowered = 12.0 * pow(roughness, 1.45) * pow(max(grazing, 1e-30), max(1.5 / roughness - 1.5, 0.0));
    let rise = square * square * grazing / (1.0 + lowered);
    return clamp(reflectance * (1.03 - 0.68 * roughness * roughness) + rise + 0.0055, 0.0, 1.0);
}

fn toon_ramp(cosine: f32, shift: f32, toony: f32) -> f32 {
    let edge = max(1.0 - toony, 0.01);
    return clamp((cosine + shift + edge) / (2.0 * edge), 0.0, 1.0);
}

// The light that a position reflects toward the eye from light `k`, given the transmittance of hair.
fn light_of(k: u32, place: Place, m: SurfaceMaterial, left: f32, rim: vec3f) -> vec3f {
    let light = frame.lights[k];
    let source = arriving(k, place.world);
    let l = source.toward;
    let facing = dot(place.n, l);
    let is_toon = m.model == 2u;
    if (facing + max(m.spread.x, select(0.0, 2.0, is_toon)) <= 0.0) {
        return vec3f(0.0);
    }
    let cosine = mix(facing, dot(place.b, l), clamp(facing / 0.3, 0.0, 1.0));
    let above = place.world + place.n * (0.002 + 0.004 * (1.0 - clamp(facing, 0.0, 1.0)));
    let through = past_body(k, above, place.n, 0.003, body_taps(k)) * left;
    if (is_toon) {
        // Only the first light shows the colour in shade, as in other viewers.
        let ramp = through * toon_ramp(cosine, m.shift, m.toony);
        let drawn = mix(select(vec3f(0.0), place.shade, k == 0u), place.albedo, ramp);
        return light.radiance * (source.share * 0.318) * (drawn + rim * through);
    }
    let diffuse = place.albedo * spread_cosine(cosine, m.spread) * (0.318 * (1.0 - place.glossy));
    let h = normalize(l + place.v);
    let nh = clamp(dot(place.b, h), 0.0, 1.0);
    let nl = max(cosine, 0.0);
    let lobes = mix(lobe(nh, nl, place.nv, m.roughness.x), lobe(nh, nl, place.nv, m.roughness.y), m.second);
    let gloss = place.bare * light.specular * nl * fresnel(m.reflectance, dot(l, h)) * lobes;
    return light.radiance * (source.share * through) * (diffuse + gloss);
}

// The light that the body reflects toward the eye.
fn shade_surface(in: Surface) -> vec3f {
    var m = materials[in.material];
    if (m.is_rough_by_texture != 0u) {
        m.roughness = max(m.roughness * in.roughness, vec2f(LEAST_ROUGHNESS));
    }
    let v = normalize(frame.eye - in.world);
    let n = normalize(in.normal);
    let b = normalize(in.bump);
    let scalp = select(in.color_scalp.w, 0.0, m.model == 1u);
    // Skin under hair has the colour of the roots, so that gaps do not look bald.
    let stretched = pow(max(frame.root_absorption, vec3f(0.0)), vec3f(STRETCH));
    let root = 0.3 * (exp(-BODY_PATH * stretched) + SURFACE_SHARE);
    var albedo = mix(in.color_scalp.rgb, root, 0.88 * smoothstep(0.15, 0.75, scalp));
    let nv = max(dot(b, v), 1e-3);
    let bare = select(0.0, 1.0 - scalp, m.reflectance > 0.0);
    let glossy = bare * mix(
        reflected_share(nv, m.roughness.x, m.reflectance),
        reflected_share(nv, m.roughness.y, m.reflectance),
        m.second,
    );
    let grazing = 1.0 - clamp(nv, 0.0, 1.0);
    albedo = mix(albedo, max(albedo, vec3f(0.5)), m.rim * grazing * grazing * grazing);
    let place = Place(in.world, n, b, v, albedo, in.shade, nv, glossy, bare);
    // The rim of a drawing: what light multiplies, and what is always seen.
    var rim = vec3f(0.0);
    if (m.model == 2u) {
        rim = m.rim_color * pow(clamp(1.0 - nv + m.rim_lift, 1e-30, 1.0), m.rim_power);
    }
    let lit_rim = rim * m.rim_lit;
    var sum = rim - lit_rim;
    if (LIGHTS > 0u) {
        sum += light_of(0u, place, m, in.hair.x, lit_rim);
    }
    if (LIGHTS > 1u) {
        sum += light_of(1u, place, m, in.hair.y, lit_rim);
    }
    if (LIGHTS > 2u) {
        sum += light_of(2u, place, m, in.hair.z, lit_rim);
    }
    if (LIGHTS > 3u) {
        sum += light_of(3u, place, m, in.hair.w, lit_rim);
    }
    // Twin of `ABOVE_SKIN` in cpu/surface/shading.rs.
    let inside = ambient_at(in.world + n * 0.008).w * in.occlusion;
    let matt = select(ambient(b), ambient_mean(), m.model == 2u) * albedo * (1.0 - glossy);
    sum += (matt + ambient_mean() * lit_rim + ambient(2.0 * dot(b, v) * b - v) * glossy) * inside;
    return sum + in.emissive;
}
