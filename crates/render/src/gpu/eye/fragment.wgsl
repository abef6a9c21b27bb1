// One strand or layer of a cluster in one pixel. Twin of `Fragment` in cpu/hair/list.rs.

struct Fragment {
    // 1 at the near plane, falling to 0 at infinity.
    depth: f32,
    // Opacity times coverage of the pixel, before the body hides it.
    alpha: f32,
    // Samples of the pixel in which it is in front of the body.
    seen: vec4<bool>,
    // Light, linear.
    color: vec3f,
    // A hash of the strand in 0..1, the distance of the middle of the segment up to a factor, and the pixel in the picture.
    hash: f32,
    middle: f32,
    at: vec2u,
}

// Opacity in the samples that the body does not hide.
fn opacity_of(fragment: Fragment) -> f32 {
    return fragment.alpha * dot(select(vec4f(0.0), vec4f(0.25), fragment.seen), vec4f(1.0));
}
