// Sums the light of fragments, weighted by the estimated transmittance in front of them.

fn take(pixel: u32, fragment: Fragment) {
    let record = pixel * RECORD_WORDS;
    let place = slice_of(record, fragment.depth);
    let slice = min(u32(place), u32(SLICES) - 1u);
    let slab = slice >> 4u;
    let last = f32(atomicLoad(&map[record + SLABS_AT + max(slab, 1u) - 1u]));
    let before = select(0.0, last, slab > 0u);
    let bits = (atomicLoad(&map[record + BITS_AT + (slice >> 5u)]) >> (16u * (slab & 1u))) & 0xffffu;
    let at = slice & 15u;
    let passed = countOneBits(bits & ((1u << at) - 1u));
    let own = min(place - f32(slice), 1.0) * f32((bits >> at) & 1u);
    let share = (f32(passed) + own) / f32(max(countOneBits(bits), 1u));
    let own_slab = f32(atomicLoad(&map[record + SLABS_AT + slab])) - before;
    let depth = (before + share * own_slab) / DEPTH_ONE;
    let weight = exp(-depth) * opacity_of(fragment) * LIGHT_ONE;
    if (before > 8.0 * DEPTH_ONE) {
        // 1/3000 of the light remains.
        return;
    }
    let light = vec3u(clamp(fragment.color, vec3f(0.0), vec3f(64.0)) * weight + 0.5);
    atomicAdd(&map[record + LIGHT_AT], light.r);
    atomicAdd(&map[record + LIGHT_AT + 1u], light.g);
    atomicAdd(&map[record + LIGHT_AT + 2u], light.b);
    atomicAdd(&map[record + LIGHT_AT + 3u], u32(weight + 0.5));
}
