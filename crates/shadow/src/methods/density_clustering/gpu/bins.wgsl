// Turns clusters into bins. Scratch memory of a cluster becomes the border behind it, and start and end of its bin.

// Half the width of a uniform distribution divided by its standard deviation.
const GAMMA: f32 = 1.7320508;
// Half the least width of a bin: a cluster at a single depth has no spread.
const LEAST_HALF: f32 = 0.5 / 256.0;
// 1 over the width of a bin without width: a step.
const STEEPEST: f32 = 1e30;

fn texel_pass(texel: u32) {
    if (is_empty(texel)) {
        return;
    }
    var centres: array<f32, 8>;
    var starts: array<f32, 8>;
    var ends: array<f32, 8>;
    var kept = 0u;
    var last = 0.0;
    for (var j = 0u; j < texels.parts; j++) {
        var middle = centre(texel, j);
        let border = select(0.5 * (last + middle), 0.0, j == 0u);
        last = middle;
        let sums = sums_of(texel, j);
        let weight = atomicLoad(&scratch[sums]);
        // Clusters without hair are removed before neighbours are compared.
        if (weight == 0u) {
            continue;
        }
        var square = over_weight(atomicLoad(&scratch[sums + 1u]), atomicLoad(&scratch[sums + 2u]), weight);
        if (texels.merged != 0u) {
            let mean = square;
            let at = bin_of(texel, j) + 1u;
            square = over_weight(atomicLoad(&map[at]), atomicLoad(&map[at + 1u]), weight);
            square = max(square - mean * mean, 0.0);
            middle = border + mean / PARTS;
        }
        let half = max(GAMMA * sqrt(square) / PARTS, LEAST_HALF);
        centres[kept] = middle;
        starts[kept] = middle - half;
        ends[kept] = middle + half;
        kept++;
    }
    for (var j = 1u; j < kept; j++) {
        if (ends[j - 1u] > starts[j]) {
            // A bin always contains its own centre.
            let border = clamp(0.5 * (ends[j - 1u] + starts[j]), centres[j - 1u], centres[j]);
            ends[j - 1u] = border;
            starts[j] = border;
        }
    }
    let range = range_of(texel);
    let depth = range.y - range.x;
    for (var j = 0u; j < texels.parts; j++) {
        let bin = bin_of(texel, j);
        let sums = sums_of(texel, j);
        var border = NOWHERE;
        var start = NOWHERE;
        var end = NOWHERE;
        atomicStore(&map[bin], 0u);
        atomicStore(&map[bin + 1u], 0u);
        atomicStore(&map[bin + 2u], 0u);
        if (j < kept) {
            start = starts[j];
            end = ends[j];
            if (j + 1u < kept) {
                border = 0.5 * (centres[j] + centres[j + 1u]);
            }
            let width = (end - start) * depth;
            atomicStore(&map[bin], bitcast<u32>(range.x + start * depth));
            atomicStore(&map[bin + 1u], bitcast<u32>(select(STEEPEST, min(1.0 / width, STEEPEST), width > 0.0)));
        }
        atomicStore(&scratch[sums], bitcast<u32>(border));
        atomicStore(&scratch[sums + 1u], bitcast<u32>(start));
        atomicStore(&scratch[sums + 2u], bitcast<u32>(end));
    }
}
