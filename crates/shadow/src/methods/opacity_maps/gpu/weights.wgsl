// Adds weights per slice and records the first slice with hair as the number of slices minus its index: 0 means no hair.

fn put(texel: u32, depth: f32, weight: u32) {
    let slice = u32(slice_of(depth).x);
    atomicAdd(&map[texel * texels.parts + slice], weight);
    let first = texels.parts - slice;
    if (atomicLoad(&scratch[texel]) < first) {
        atomicMax(&scratch[texel], first);
    }
}
