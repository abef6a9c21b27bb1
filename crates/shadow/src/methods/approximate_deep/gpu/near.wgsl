// The nearest depth. Its bits are inverted, so that 0 means no hair.

fn put(texel: u32, depth: f32, weight: u32) {
    // Depths are not negative, so their bits have the same order.
    let turned = ~bitcast<u32>(depth);
    if (atomicLoad(&map[texel]) < turned) {
        atomicMax(&map[texel], turned);
    }
}
