// The light on the visible ground. Twin of `ground_place` and `ground_light` in cpu/backdrop.rs.

const UP: vec3f = vec3f(0.0, 1.0, 0.0);

// The unshadowed light `k` on the ground.
fn share_of(k: u32, p: vec3f) -> vec3f {
    let source = arriving(k, p);
    return frame.lights[k].radiance * (max(source.toward.y, 0.0) * source.share);
}

// The fraction of it that arrives.
fn left_on_ground(k: u32, p: vec3f) -> f32 {
    return past_body(k, p, UP, 0.004, 6u) * columns_light(k, p);
}

// The fraction of the light on the ground behind a position of the picture, and whether there is ground: 1 or 0. Without shadow, and above
// the horizon, the fraction is 1.
fn ground_light(ndc: vec2f) -> vec4f {
    let near = frame.world_from_clip * vec4f(ndc, 1.0, 1.0);
    let eye = frame.eye;
    let ray = normalize(near.xyz / near.w - eye);
    if (!(ray.y < -1e-3 && eye.y > 0.0)) {
        return vec4f(1.0, 1.0, 1.0, 0.0);
    }
    let p = eye - ray * (eye.y / ray.y);
    var full = ambient(UP) * 3.14159;
    var lit = full;
    if (LIGHTS > 0u) {
        full += share_of(0u, p);
        lit += share_of(0u, p) * left_on_ground(0u, p);
    }
    if (LIGHTS > 1u) {
        full += share_of(1u, p);
        lit += share_of(1u, p) * left_on_ground(1u, p);
    }
    if (LIGHTS > 2u) {
        full += share_of(2u, p);
        lit += share_of(2u, p) * left_on_ground(2u, p);
    }
    if (LIGHTS > 3u) {
        full += share_of(3u, p);
        lit += share_of(3u, p) * left_on_ground(3u, p);
    }
    // Without light there is no shadow.
    let least = vec3f(1e-4);
    return vec4f((lit + max(least - full, vec3f(0.0))) / max(full, least), 1.0);
}

// Pixels along each edge of a cell: most of the ground is lit uniformly, so it is evaluated at the corners of cells first.
const CELL: u32 = 4u;

// A fraction of the light in three times ten bits; the highest bit is set if there is ground.
fn pack_share(share: vec4f) -> u32 {
    let parts = vec3u(clamp(share.rgb, vec3f(0.0), vec3f(1.0)) * 1023.0 + 0.5);
    return parts.r | (parts.g << 10u) | (parts.b << 20u) | select(0u, 0x80000000u, share.w > 0.5);
}

fn unpack_share(packed: u32) -> vec4f {
    let parts = vec3u(packed, packed >> 10u, packed >> 20u) & vec3u(1023u);
    return vec4f(vec3f(parts) / 1023.0, f32(packed >> 31u));
}

// Corners per row.
fn corner_columns() -> u32 {
    return (u32(frame.size.x) + CELL - 1u) / CELL + 1u;
}
