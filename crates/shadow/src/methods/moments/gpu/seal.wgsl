// Writes the range, the weight and the moments into the record.

fn texel_pass(texel: u32) {
    if (weight_of(texel) == 0.0) {
        return;
    }
    let record = record_of(texel);
    write_header(texel, record);
    var moments: vec4f;
    for (var k = 0u; k < 4u; k++) {
        moments[k] = number_of(atomicLoad(&scratch[sums_of(texel) + k]));
    }
    let first = record + HEADER;
    if (SHORT) {
        let words = pack_moments(moments);
        atomicStore(&map[first], words.x);
        atomicStore(&map[first + 1u], words.y);
    } else {
        for (var k = 0u; k < 4u; k++) {
            atomicStore(&map[first + k], bitcast<u32>(moments[k]));
        }
    }
}
