// Sums the slices of each column along the light, in place.

fn texel_pass(texel: u32) {
    let first = record_of(texel) + HEADER;
    var sum = 0u;
    for (var slice = 0u; slice < texels.parts; slice++) {
        sum += atomicLoad(&map[first + slice]);
        atomicStore(&map[first + slice], sum);
    }
}
