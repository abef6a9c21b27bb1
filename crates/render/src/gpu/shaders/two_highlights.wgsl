// Shading of one point of a strand: Kajiya-Kay with two shifted highlights, light through the fibre and a colour that deepens inside hair.
//
// Kajiya, Kay 1989; the shift along the strand after Marschner et al. 2003, as Xu et al. use it. With both
// vectors pointing away from the fibre the highlight is where t.v = -t.l (the mirrored cone), so the cosine is
// sin sin - (t.l)(t.v). Turning the tangent by an angle s toward the normal adds 2 s to the sum of inclinations.

struct StrandColor {
    // Light scattered many times.
    body: vec3f,
    // Light reflected at the far wall of the fibre.
    second: vec3f,
    // Light that passed through the fibre once.
    through: vec3f,
}

// Colours of a strand that absorbs `sigma` per unit of path.
fn strand_color(sigma: vec3f) -> StrandColor {
    // Twin of `HairLook::body_color` in groom: paths of many lengths, and a grey part that only met surfaces.
    let s = pow(max(sigma, vec3f(0.0)), vec3f(STRETCH));
    return StrandColor(exp(-BODY_PATH * s) + SURFACE_SHARE, exp(-4.1 * s) + 0.02, exp(-3.15 * s) + 0.02);
}

// Light that a strand with unit tangent `t` (root to tip) sends toward `v` per unit of light from `l`;
// `l` and `v` are unit vectors that point away from it. `lit` in 0..1 is the transmittance there.
fn strand_light(t: vec3f, l: vec3f, v: vec3f, color: StrandColor, specular: f32, lit: f32) -> vec3f {
    let sin_l = dot(t, l);
    let sin_v = dot(t, v);
    let cos_l = sqrt(max(1.0 - sin_l * sin_l, 0.0));
    let cos_v = sqrt(max(1.0 - sin_v * sin_v, 0.0));

    // cos(theta_l + theta_v + 2 shift), shift +0.06 for the first and -0.11 for the second highlight.
    let cos_sum = cos_l * cos_v - sin_l * sin_v;
    let sin_sum = sin_l * cos_v + cos_l * sin_v;
    let first = pow(max(cos_sum * 0.99281 - sin_sum * 0.11971, 0.0), frame.primary_exponent);
    let second = pow(max(cos_sum * 0.97590 + sin_sum * 0.21823, 0.0), frame.secondary_exponent);
    // Light that passes nearly straight through: only if the light is behind the strand.
    let across_l = l - t * sin_l;
    let across_v = v - t * sin_v;
    let azimuth = dot(across_l, across_v) / max(cos_l * cos_v, 1e-3);
    let behind = pow(clamp(0.5 - 0.5 * azimuth, 0.0, 1.0), 6.0);
    let front = 0.35 + 0.65 * clamp(0.5 + 0.5 * azimuth, 0.0, 1.0);

    // Light that has passed through other hair is more coloured with depth.
    let deep = pow(color.body, vec3f(1.0 + 0.45 * (1.0 - lit)));
    let diffuse = 0.32 * cos_l * deep;
    let reflected = 0.13 * frame.primary_strength * first * front * vec3f(1.0)
        + 0.40 * frame.secondary_strength * second * front * color.second;
    let passed = 0.50 * behind * pow(max(cos_sum, 0.0), 4.0) * color.through;
    return diffuse + specular * (reflected + passed);
}
