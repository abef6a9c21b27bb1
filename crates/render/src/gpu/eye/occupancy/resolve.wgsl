// Normalises the sum to the exact total opacity, because the estimate dims it.

fn pixel_pass(pixel: u32) {
    let record = pixel * RECORD_WORDS;
    if (atomicLoad(&map[record]) == 0u) {
        write_layer(pixel, vec3f(0.0), 1.0);
        return;
    }
    let through = exp(-f32(atomicLoad(&map[record + SLABS_AT + 7u])) / DEPTH_ONE);
    let light = vec3f(
        f32(atomicLoad(&map[record + LIGHT_AT])),
        f32(atomicLoad(&map[record + LIGHT_AT + 1u])),
        f32(atomicLoad(&map[record + LIGHT_AT + 2u])),
    );
    let weight = f32(atomicLoad(&map[record + LIGHT_AT + 3u]));
    write_layer(pixel, light * ((1.0 - through) / max(weight, 1.0)), through);
}
