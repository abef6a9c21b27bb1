// Adds weights to bins: to that of the nearest centre, but for a bin that holds the fragment.

// A fragment that lies so little outside the bin of its own cluster counts as within.
const SLACK: f32 = 1.0 / 65536.0;

fn put(texel: u32, depth: f32, weight: u32) {
    let part = part_of(texel, depth);
    let first = sums_of(texel, 0u);
    var j = 0u;
    while (j + 1u < texels.whole.x && part > bitcast<f32>(atomicLoad(&scratch[first + 3u * j]))) {
        j++;
    }
    let at = first + 3u * j;
    if (j > 0u && part < bitcast<f32>(atomicLoad(&scratch[at + 1u])) - SLACK
        && part <= bitcast<f32>(atomicLoad(&scratch[at - 1u]))) {
        j--;
    } else if (j + 1u < texels.whole.x && part > bitcast<f32>(atomicLoad(&scratch[at + 2u])) + SLACK
        && part >= bitcast<f32>(atomicLoad(&scratch[at + 4u]))) {
        j++;
    }
    atomicAdd(&map[bin_of(texel, j) + 2u], weight);
}
