// Adds weights by slice, and notes the first slice with hair: turned round, so that 0 stands for none at all.

fn put(texel: u32, depth: f32, weight: u32) {
    let slice = u32(slice_of(depth).x);
    atomicAdd(&map[texel * texels.whole.x + slice], weight);
    let first = texels.whole.x - slice;
    if (atomicLoad(&scratch[texel]) < first) {
        atomicMax(&scratch[texel], first);
    }
}
