// The body, lit, with the shadow of the hair and its own.

struct Surface {
    world: vec3f,
    normal: vec3f,
    // Linear sRGB; w is 1 where hair grows.
    color_scalp: vec4f,
    // Transmittance of hair toward four lights.
    hair: vec4f,
}

// Light that the body sends toward the eye.
fn shade_surface(in: Surface) -> vec3f {
    let v = normalize(frame.eye_lights.xyz - in.world);
    let n = normalize(in.normal);
    // Under hair the skin is painted with the colour of the roots, so that gaps never read as baldness.
    let root = 0.3 * (exp(-2.8 * pow(max(frame.absorption_variation.xyz, vec3f(0.0)), vec3f(0.7))) + 0.012);
    let albedo = mix(in.color_scalp.rgb, root, 0.88 * smoothstep(0.15, 0.75, in.color_scalp.w));
    let skin = 1.0 - in.color_scalp.w;
    var sum = vec3f(0.0);
    var open = 0.0;
    let lights = light_count();
    var k = 0u;
    loop {
        let light = frame.lights[k];
        let l = -light.direction_specular.xyz;
        let facing = dot(n, l);
        open += select(0.0, in.hair[k], k < lights);
        // Light wraps a little round skin; the shadow map is asked only where light can come.
        let wrapped = clamp((facing + 0.12) / 1.12, 0.0, 1.0);
        if (wrapped > 0.0 && k < lights) {
            // Where light grazes the skin, the flat triangles of a round limb keep it from each other.
            let above = in.world + n * (0.002 + 0.004 * (1.0 - clamp(facing, 0.0, 1.0)));
            let lit = body_light(k, above, lean_of(k, n), 0.003, SURFACE_TAPS) * in.hair[k];
            let h = normalize(l + v);
            let gloss = 0.014 * skin * light.direction_specular.w
                * (pow(max(dot(n, h), 0.0), 24.0) + 0.6 * pow(1.0 - max(dot(n, v), 0.0), 4.0));
            sum += light.radiance_blur.xyz * lit * (albedo * wrapped * 0.318 + vec3f(gloss) * clamp(facing, 0.0, 1.0));
        }
        k++;
        continuing {
            break if k >= lights;
        }
    }
    let inside = select(1.0, open / f32(max(lights, 1u)), lights > 0u);
    sum += 0.5 * ambient(n) * albedo * (0.35 + 0.65 * inside);
    return sum;
}
