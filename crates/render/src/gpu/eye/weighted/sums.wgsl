// All sums in one pass.

fn take(pixel: u32, fragment: Fragment) {
    let record = pixel * RECORD_WORDS;
    let weight = opacity_of(fragment) * LIGHT_ONE;
    let light = vec3u(clamp(fragment.color, vec3f(0.0), vec3f(64.0)) * weight + 0.5);
    atomicAdd(&map[record], light.r);
    atomicAdd(&map[record + 1u], light.g);
    atomicAdd(&map[record + 2u], light.b);
    atomicAdd(&map[record + 3u], u32(weight + 0.5));
    atomicAdd(&map[record + 4u], 1u);
}
