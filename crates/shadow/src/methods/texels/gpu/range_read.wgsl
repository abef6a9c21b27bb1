// Reads the results of range.wgsl.

fn near_of(texel: u32) -> f32 {
    return bitcast<f32>(~atomicLoad(&scratch[texel * 3u]));
}

fn far_of(texel: u32) -> f32 {
    return bitcast<f32>(atomicLoad(&scratch[texel * 3u + 1u]));
}

fn weight_of(texel: u32) -> u32 {
    return atomicLoad(&scratch[texel * 3u + 2u]);
}
