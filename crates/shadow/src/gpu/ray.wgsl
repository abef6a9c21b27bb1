// What a straight piece of strand is on the plane of a light. Its ends are the output of project.wgsl: the distance from the light less that
// of the anchor, the place on the plane, and the factor on the width.

// The largest factor on the width of a strand. Twin of `MAX_WIDENING` in perspective/mod.rs.
const MAX_WIDENING: f32 = 32.0;

// The distance from the light less that of the anchor, and the factor on the width, at the fraction `t` between two ends. On the plane
// the factor is linear, and the distance is not, unless the piece is short: see perspective/ray.rs.
fn on_ray(a: vec4f, b: vec4f, t: f32, plane: f32, start: f32) -> vec2f {
    let middle = a + (b - a) * t;
    let from_light = a.x + start;
    let there = sqrt(plane * plane + dot(middle.yz, middle.yz));
    let first = sqrt(plane * plane + dot(a.yz, a.yz));
    let curved = from_light * (a.w / middle.w) * (there / first) - start;
    let is_short = 16.0 * distance(a.xyz, b.xyz) < from_light;
    return vec2f(select(curved, middle.x, is_short), min(middle.w, MAX_WIDENING));
}
