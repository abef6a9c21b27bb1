// Reads the results of range.wgsl.

fn near_of(texel: u32) -> f32 {
    return bitcast<f32>(~atomicLoad(&scratch[texel * 4u]));
}

fn far_of(texel: u32) -> f32 {
    return bitcast<f32>(atomicLoad(&scratch[texel * 4u + 1u]));
}

fn weight_of(texel: u32) -> f32 {
    let low = atomicLoad(&scratch[texel * 4u + 2u]);
    return f32(atomicLoad(&scratch[texel * 4u + 3u])) * 4294967296.0 + f32(low);
}
