// Writes the bits of that depth in place of light.

fn pixel_pass(pixel: u32) {
    layer[eye.first + pixel] = vec2u(atomicLoad(&map[pixel]), 0u);
}
