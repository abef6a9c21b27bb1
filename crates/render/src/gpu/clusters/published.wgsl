// The light on ribs as published: a matt part and two shifted highlights (Xu et al., "SATF", equations 8 to 11). Twin of
// cpu/clusters/published.rs and of satf/src/lighting.rs. Joined with rib_light.wgsl.

const PRIMARY_SHIFT: f32 = 0.1;
const SECONDARY_SHIFT: f32 = 0.15;
const PRIMARY_EXPONENT: f32 = 80.0;
const SECONDARY_EXPONENT: f32 = 20.0;

fn sine_of(cosine: f32) -> f32 {
    return sqrt(max(1.0 - cosine * cosine, 0.0));
}

fn shifted_tangent(tangent: vec3f, normal: vec3f, shift: f32) -> vec3f {
    let v = tangent + shift * normal;
    let size = length(v);
    return select(tangent, v / max(size, 1e-30), size > 1e-30);
}

// 1 on the cone of mirrored directions.
fn published_highlight(tangent: vec3f, l: vec3f, v: vec3f, exponent: f32) -> f32 {
    let along_l = dot(tangent, l);
    let along_v = dot(tangent, v);
    return pow(max(sine_of(along_l) * sine_of(along_v) - along_l * along_v, 0.0), exponent);
}

@compute @workgroup_size(64)
fn published_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    let ring = ring_points();
    if (i >= clusters.count * 2u * ring) {
        return;
    }
    let at = i % ring;
    let inner = i / (2u * ring) * (2u * ring);
    let normal = surface_at(inner, at).normal;
    let section = at % (clusters.along + 1u);
    let tangent = tangent_at(i - section, section);
    let p = points[i].xyz;
    let v = unit_or_zero(clusters.eye - p);
    let color = strand_color(frame.mean_absorption).body;
    put_part(i, 0u, ambient(vec3f(0.0, 0.3, 0.0)) * color * 0.22);
    for (var k = 0u; k < LIGHTS; k++) {
        let light = frame.lights[k];
        let source = arriving(k, p);
        let l = source.toward;
        let lit = f32((light_left[i] >> (8u * k)) & 255u) / 255.0 * (body_light_on_strand(k, p) * source.share);
        let matt = clusters.matt * sine_of(dot(tangent, l));
        let first = clusters.primary
            * published_highlight(shifted_tangent(tangent, normal, PRIMARY_SHIFT), l, v, PRIMARY_EXPONENT);
        let second = clusters.secondary
            * published_highlight(shifted_tangent(tangent, normal, -SECONDARY_SHIFT), l, v, SECONDARY_EXPONENT);
        put_part(i, 1u + k, light.radiance * (color * (matt + second) + first) * lit);
    }
}
