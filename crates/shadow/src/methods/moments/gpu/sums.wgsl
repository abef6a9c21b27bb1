// The integer sums of a texel lie behind the ranges of all texels.

fn sums_of(texel: u32) -> u32 {
    return texels.count * 4u + texel * 2u * ORDER;
}
