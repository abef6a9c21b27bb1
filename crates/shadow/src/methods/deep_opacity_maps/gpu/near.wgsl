// The nearest depth.

fn put(texel: u32, depth: f32, weight: u32) {
    // Depths are not negative, so their bits have the same order.
    let turned = ~bitcast<u32>(depth);
    let at = record_of(texel);
    if (atomicLoad(&map[at]) < turned) {
        atomicMax(&map[at], turned);
    }
}
