// Writes the depth range and the mean weight into the record.

fn texel_pass(texel: u32) {
    let weight = weight_of(texel);
    if (weight == 0.0) {
        return;
    }
    let record = record_of(texel);
    var count = 0u;
    let first = counts_of(record);
    for (var k = 0u; k < SLABS / 2u; k++) {
        let two = atomicLoad(&map[first + k]);
        count += (two & 0xffffu) + (two >> 16u);
    }
    atomicStore(&map[record], bitcast<u32>(near_of(texel)) & ~7u);
    atomicStore(&map[record + 1u], (bitcast<u32>(far_of(texel)) + 7u) & ~7u);
    // The total stays exact where counts have saturated.
    atomicStore(&map[record + 2u], bitcast<u32>(weight / f32(max(count, 1u))));
}
