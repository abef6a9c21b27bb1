// The initial centres of clusters. Twin of seeds.rs.

fn even(j: u32) -> f32 {
    return (f32(j) + 0.5) / f32(texels.parts);
}

fn texel_pass(texel: u32) {
    if (is_empty(texel)) {
        return;
    }
    if (texels.seeds != 2u) {
        let drawn = select(1.0, 0.75, texels.seeds == 1u);
        for (var j = 0u; j < texels.parts; j++) {
            set_centre(texel, j, even(j) * drawn);
        }
        return;
    }
    // Light lost before the end of each bin.
    let first = sums_of(texel, 0u);
    var lost: array<f32, 33>;
    var sum = 0u;
    for (var bin = 0u; bin < HISTOGRAM_BINS; bin++) {
        sum += atomicLoad(&scratch[first + bin]);
        lost[bin + 1u] = 1.0 - exp_of_minus(depth_of_weight(f32(sum)));
        atomicStore(&scratch[first + bin], 0u);
    }
    var bin = 0u;
    for (var j = 0u; j < texels.parts; j++) {
        let wanted = lost[HISTOGRAM_BINS] * (f32(j) + 0.5) / f32(texels.parts);
        while (bin + 1u < HISTOGRAM_BINS && lost[bin + 1u] < wanted) {
            bin++;
        }
        let in_bin = lost[bin + 1u] - lost[bin];
        let part = select(0.5, clamp((wanted - lost[bin]) / in_bin, 0.0, 1.0), in_bin > 0.0);
        set_centre(texel, j, even(j) * 0.5 + (f32(bin) + part) / f32(HISTOGRAM_BINS) * 0.5);
    }
}
