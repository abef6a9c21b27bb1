// Sums weights along the light, in place, from the first slice with hair on. The slices before it are 0 already.

fn texel_pass(texel: u32) {
    let after = atomicLoad(&scratch[texel]);
    let record = texel * texels.parts;
    var sum = 0u;
    for (var slice = texels.parts - after; slice < texels.parts; slice++) {
        sum += atomicLoad(&map[record + slice]);
        atomicStore(&map[record + slice], sum);
    }
}
