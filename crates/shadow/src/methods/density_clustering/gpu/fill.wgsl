// Adds the weight of a fragment to the bin of the nearest centre, unless the bin of a neighbour contains the fragment.

// The distance outside the bin of its own cluster at which a fragment still counts as inside.
const SLACK: f32 = 1.0 / 65536.0;

fn put(texel: u32, depth: f32, weight: u32) {
    let part = part_of(texel, depth);
    let first = sums_of(texel, 0u);
    var j = 0u;
    while (j + 1u < texels.parts && part > bitcast<f32>(atomicLoad(&scratch[first + 3u * j]))) {
        j++;
    }
    let at = first + 3u * j;
    if (j > 0u && part < bitcast<f32>(atomicLoad(&scratch[at + 1u])) - SLACK
        && part <= bitcast<f32>(atomicLoad(&scratch[at - 1u]))) {
        j--;
    } else if (j + 1u < texels.parts && part > bitcast<f32>(atomicLoad(&scratch[at + 2u])) + SLACK
        && part >= bitcast<f32>(atomicLoad(&scratch[at + 4u]))) {
        j++;
    }
    atomicAdd(&map[bin_of(texel, j) + 2u], weight);
}
