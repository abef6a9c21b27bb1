// The mean of the samples.

fn pixel_pass(pixel: u32) {
    var color = vec3f(0.0);
    var through = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let at = pixel * RECORD_WORDS + k;
        if (atomicLoad(&map[at]) == 0u) {
            through += 0.25;
        } else {
            color += 0.25 * unpack_color(atomicLoad(&map[at + 4u]));
        }
    }
    write_layer(pixel, color, through);
}
