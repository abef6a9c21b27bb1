// The bits of that depth in the place of the light.

fn pixel_pass(pixel: u32) {
    layer[eye.first + pixel] = vec2u(atomicLoad(&map[pixel]), 0u);
}
