// Places the slices of each column.

fn texel_pass(texel: u32) {
    if (weight_of(texel) == 0.0) {
        return;
    }
    let first = weights_of(texel);
    var whole = 0.0;
    for (var bin = 0u; bin < BINS; bin++) {
        whole += f32(atomicLoad(&scratch[first + bin]));
    }
    var shares: array<u32, 2>;
    var before = 0.0;
    for (var bin = 0u; bin < BINS; bin++) {
        let share = min(u32(before / whole * SHARES + 0.5), 255u);
        shares[bin >> 2u] |= share << (8u * (bin & 3u));
        before += f32(atomicLoad(&scratch[first + bin]));
    }
    let record = record_of(texel);
    atomicStore(&map[record], rounded_range(texel));
    atomicStore(&map[record + 1u], shares[0]);
    atomicStore(&map[record + 2u], shares[1]);
}
