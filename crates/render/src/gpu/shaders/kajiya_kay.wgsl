// Shading of one point of a strand by Kajiya-Kay as published: one highlight that is not shifted, and a matt part.
//
// Kajiya, Kay 1989. Printed is (t.l)(t.v) + sin sin, with l in the direction in which light travels. With both vectors pointing away from
// the fibre, the highlight is where t.v = -t.l (the mirrored cone), so the product is subtracted.

const ONE_OVER_PI: f32 = 0.318309886;

// Light that a strand with unit tangent `t` sends toward `v` per unit of light from `l`, which are unit vectors that point away from it.
fn published_strand_light(t: vec3f, l: vec3f, v: vec3f, color: vec3f, specular: f32) -> vec3f {
    let along_l = dot(t, l);
    let along_v = dot(t, v);
    let across_l = sqrt(max(1.0 - along_l * along_l, 0.0));
    let across_v = sqrt(max(1.0 - along_v * along_v, 0.0));
    let mirrored = max(across_l * across_v - along_l * along_v, 0.0);
    let shine = specular * frame.primary_strength * pow(mirrored, frame.primary_exponent);
    return ONE_OVER_PI * (color * across_l + shine);
}
