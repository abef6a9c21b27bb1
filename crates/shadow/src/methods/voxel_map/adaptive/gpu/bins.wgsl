// The weights of the bins of each column, in scratch memory behind the ranges.

// Words of scratch memory of a range.
const RANGE_WORDS: u32 = 4u;

// The first of the bins of a column.
fn weights_of(texel: u32) -> u32 {
    return texels.count * RANGE_WORDS + texel * BINS;
}

// Both ends of a column with hair, rounded outward, and never empty.
fn rounded_range(texel: u32) -> u32 {
    let near = min(u32(near_of(texel) * DEPTHS), 65534u);
    return near | (clamp(u32(ceil(far_of(texel) * DEPTHS)), near + 1u, 65535u) << 16u);
}
