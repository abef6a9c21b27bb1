// Sums weights along the light, in place. Before the first slice with hair, and where there is none, all is 0 already.

fn texel_pass(texel: u32) {
    let after = atomicLoad(&scratch[texel]);
    let record = texel * texels.whole.x;
    var sum = 0u;
    for (var slice = texels.whole.x - after; slice < texels.whole.x; slice++) {
        sum += atomicLoad(&map[record + slice]);
        atomicStore(&map[record + slice], sum);
    }
}
