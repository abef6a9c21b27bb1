// The samples of a pixel that an opacity covers: their number is four times the opacity, rounded up or down by a hash of the pixel and
// the strand; the first one depends on the strand. Strands of a pixel cover different samples, so that many thin ones add up. Twin of
// `covered_samples` in cpu/hair/list.rs.
fn covered_samples(fragment: Fragment) -> u32 {
    let hash = fragment.hash;
    let pixel = vec2f(fragment.at);
    let noise = fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715))) + 13.7 * hash);
    let count = u32(clamp(floor(fragment.alpha * 4.0 + noise), 0.0, 4.0));
    let first = u32(hash * 4.0) & 3u;
    let samples = ((1u << count) - 1u) << first;
    return (samples | (samples >> 4u)) & 15u & dot(select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), fragment.seen), vec4u(1u));
}
