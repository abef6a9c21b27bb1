// Writes the range, the weight and the means into the record, and counts the records whose means no distribution has.

fn texel_pass(texel: u32) {
    if (weight_of(texel) == 0.0) {
        return;
    }
    let record = record_of(texel);
    write_header(texel, record);
    var means: array<f32, 8>;
    let first = record + HEADER;
    for (var k = 0u; k < 2u * ORDER; k++) {
        means[k] = number_of(atomicLoad(&scratch[sums_of(texel) + k]));
        if (!SHORT) {
            atomicStore(&map[first + k], bitcast<u32>(means[k]));
        }
    }
    if (SHORT) {
        for (var k = 0u; k < ORDER; k++) {
            let words = vec2u(to_short(means[2u * k]), to_short(means[2u * k + 1u]));
            atomicStore(&map[first + k], words.x | (words.y << 16u));
            means[2u * k] = from_short(words.x);
            means[2u * k + 1u] = from_short(words.y);
        }
    }
    let ends = ends_of(texel);
    if (ends.x != ends.y && !system_of(means).is_solvable) {
        count_fallback();
    }
}
