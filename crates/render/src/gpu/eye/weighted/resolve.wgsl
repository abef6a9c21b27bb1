// The average of all fragments, blended as many times as there are fragments.

fn pixel_pass(pixel: u32) {
    let record = pixel * RECORD_WORDS;
    let count = f32(atomicLoad(&map[record + 4u]));
    if (count == 0.0) {
        write_layer(pixel, vec3f(0.0), 1.0);
        return;
    }
    let weight = f32(atomicLoad(&map[record + 3u]));
    let mean = min(weight / (LIGHT_ONE * count), 1.0);
    let through = pow(1.0 - mean, count);
    let light = vec3f(
        f32(atomicLoad(&map[record])),
        f32(atomicLoad(&map[record + 1u])),
        f32(atomicLoad(&map[record + 2u])),
    );
    write_layer(pixel, light * ((1.0 - through) / max(weight, 1.0)), through);
}
