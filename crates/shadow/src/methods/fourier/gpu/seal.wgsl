// Writes the range and the weight into the record, and turns integers into coefficients.

fn texel_pass(texel: u32) {
    if (weight_of(texel) == 0.0) {
        return;
    }
    let record = record_of(texel);
    write_header(texel, record);
    for (var k = 0u; k < 2u * TERMS; k++) {
        let at = record + HEADER + k;
        let factor = texels.starts[k >> 3u][(k >> 1u) & 3u];
        atomicStore(&map[at], bitcast<u32>(number_of(atomicLoad(&map[at])) * factor));
    }
}
