// Writes the depth range and the mean weight into the record.

fn texel_pass(texel: u32) {
    let weight = weight_of(texel);
    if (weight == 0u) {
        return;
    }
    let record = record_of(texel);
    var count = 0u;
    let first = counts_of(record);
    for (var k = 0u; k < SLABS / 2u; k++) {
        let two = atomicLoad(&map[first + k]);
        count += (two & 0xffffu) + (two >> 16u);
    }
    // Where counts have saturated, the mean compensates.
    let mean = u32(clamp(round(f32(weight) / f32(max(count, 1u))) - 1023.0, 1.0, 1023.0));
    let near = bitcast<u32>(near_of(texel)) >> 3u;
    let far = (bitcast<u32>(far_of(texel)) + 7u) >> 3u;
    atomicStore(&map[record], (near << SPARE) | (mean & 31u));
    atomicStore(&map[record + 1u], (far << SPARE) | (mean >> 5u));
}
