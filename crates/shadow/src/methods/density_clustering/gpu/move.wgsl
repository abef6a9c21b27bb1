// Moves centres to the mean of their hair.

fn texel_pass(texel: u32) {
    if (is_empty(texel)) {
        return;
    }
    var last = centre(texel, 0u);
    var border = 0.0;
    for (var j = 0u; j < texels.parts; j++) {
        let next = centre(texel, j);
        if (j > 0u) {
            border = 0.5 * (last + next);
        }
        last = next;
        let sums = sums_of(texel, j);
        let weight = atomicLoad(&scratch[sums]);
        if (weight > 0u) {
            let mean = over_weight(atomicLoad(&scratch[sums + 1u]), atomicLoad(&scratch[sums + 2u]), weight);
            set_centre(texel, j, border + mean / PARTS);
            atomicStore(&scratch[sums], 0u);
            atomicStore(&scratch[sums + 1u], 0u);
            atomicStore(&scratch[sums + 2u], 0u);
        }
    }
}
