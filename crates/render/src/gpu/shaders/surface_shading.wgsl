// Shading of the body, with shadows of the hair and of itself.

struct Surface {
    world: vec3f,
    normal: vec3f,
    // Linear sRGB; w is 1 where hair grows.
    color_scalp: vec4f,
    // Transmittance of hair toward four lights.
    hair: vec4f,
}

// A position to shade: its unit normal, the unit vector toward the eye, its colour, and its fraction of bare skin.
struct Place { world: vec3f, n: vec3f, v: vec3f, albedo: vec3f, skin: f32 }

// How far light reaches around skin past its edge, as a cosine: red light travels furthest below the surface.
const WRAP: vec3f = vec3f(0.12, 0.09, 0.07);

// The light that a position reflects toward the eye from light `k`, given the transmittance of hair.
fn light_of(k: u32, place: Place, left: f32) -> vec3f {
    let light = frame.lights[k];
    let source = arriving(k, place.world);
    let l = source.toward;
    let facing = dot(place.n, l);
    // Light wraps a little around skin; the shadow map is looked up only where light can arrive.
    let wrapped = clamp((facing + WRAP) / (1.0 + WRAP), vec3f(0.0), vec3f(1.0));
    var sum = vec3f(0.0);
    if (wrapped.r > 0.0) {
        // At grazing angles the flat triangles of a round limb shadow each other.
        let above = place.world + place.n * (0.002 + 0.004 * (1.0 - clamp(facing, 0.0, 1.0)));
        let lit = past_body(k, above, place.n, 0.003, body_taps(k)) * left * source.share;
        let h = normalize(l + place.v);
        let gloss = 0.014 * place.skin * light.specular
            * (pow(max(dot(place.n, h), 0.0), 24.0) + 0.6 * pow(1.0 - max(dot(place.n, place.v), 0.0), 4.0));
        sum = light.radiance * lit
            * (place.albedo * wrapped * 0.318 + vec3f(gloss) * clamp(facing, 0.0, 1.0));
    }
    return sum;
}

// The light that the body reflects toward the eye.
fn shade_surface(in: Surface) -> vec3f {
    let v = normalize(frame.eye - in.world);
    let n = normalize(in.normal);
    // Skin under hair has the colour of the roots, so that gaps do not look bald.
    let stretched = pow(max(frame.root_absorption, vec3f(0.0)), vec3f(STRETCH));
    let root = 0.3 * (exp(-BODY_PATH * stretched) + SURFACE_SHARE);
    let albedo = mix(in.color_scalp.rgb, root, 0.88 * smoothstep(0.15, 0.75, in.color_scalp.w));
    let place = Place(in.world, n, v, albedo, 1.0 - in.color_scalp.w);
    var sum = vec3f(0.0);
    if (LIGHTS > 0u) {
        sum += light_of(0u, place, in.hair.x);
    }
    if (LIGHTS > 1u) {
        sum += light_of(1u, place, in.hair.y);
    }
    if (LIGHTS > 2u) {
        sum += light_of(2u, place, in.hair.z);
    }
    if (LIGHTS > 3u) {
        sum += light_of(3u, place, in.hair.w);
    }
    // Hair that lies on skin shadows it: twin of `ABOVE_SKIN` in cpu/surface/shading.rs.
    sum += ambient(n) * albedo * ambient_at(in.world + n * 0.008).w;
    return sum;
}
