// Where the clusters of a texel are. Within a texel depths are parts of its range, 0 to 1 from the nearest fragment to the
// farthest: so they keep all their digits where the range is short.
//
// Scratch memory of a texel: the nearest depth turned round, so that 0 stands for none at all; the farthest; then three words
// a cluster, or 32 of a histogram while clusters have no place yet. `texels.whole`: clusters, seeds (0 even, 1 drawn toward
// the light, 2 by the histogram), 1 where the deviation is found along with the centres, 1 for filtered lines.
//
// A record has three words a cluster, which hold its bin in the end: start, one over the width, weight. Until then the first
// is the cluster's centre.

const HISTOGRAM_BINS: u32 = 32u;

// Distances are counted in parts of this: with a weight of up to √2 · 1024 they fit into a word, and squares into two.
const PARTS: f32 = 1048576.0;

// Beyond any depth of a texel.
const NOWHERE: f32 = 2.0;

fn scratch_of(texel: u32) -> u32 {
    return texel * (2u + select(3u * texels.whole.x, max(3u * texels.whole.x, HISTOGRAM_BINS), texels.whole.y == 2u));
}

// The first word of cluster `j` in scratch memory.
fn sums_of(texel: u32, j: u32) -> u32 {
    return scratch_of(texel) + 2u + 3u * j;
}

// The first word of bin `j` of the record.
fn bin_of(texel: u32, j: u32) -> u32 {
    return 3u * (texel * texels.whole.x + j);
}

fn is_empty(texel: u32) -> bool {
    return atomicLoad(&scratch[scratch_of(texel)]) == 0u;
}

// Nearest and farthest depth.
fn range_of(texel: u32) -> vec2f {
    let at = scratch_of(texel);
    return vec2f(bitcast<f32>(~atomicLoad(&scratch[at])), bitcast<f32>(atomicLoad(&scratch[at + 1u])));
}

// A depth as a part of the texel's range; 0 where there is none.
fn part_of(texel: u32, depth: f32) -> f32 {
    let range = range_of(texel);
    let part = (depth - range.x) * (1.0 / (range.y - range.x));
    // What is no number becomes 0.
    return min(select(0.0, part, part > 0.0), 1.0);
}

fn centre(texel: u32, j: u32) -> f32 {
    return bitcast<f32>(atomicLoad(&map[bin_of(texel, j)]));
}

fn set_centre(texel: u32, j: u32, part: f32) {
    atomicStore(&map[bin_of(texel, j)], bitcast<u32>(part));
}

// The cluster of a depth, and the border before it; a tie goes to the nearer cluster.
struct Place {
    cluster: u32,
    border: f32,
}

fn place_of(texel: u32, part: f32) -> Place {
    var place = Place(0u, 0.0);
    var last = centre(texel, 0u);
    for (var j = 1u; j < texels.whole.x; j++) {
        let next = centre(texel, j);
        let border = 0.5 * (last + next);
        if (!(part > border)) {
            break;
        }
        place = Place(j, border);
        last = next;
    }
    return place;
}

// A distance of 0 to 1.
fn counted(distance: f32) -> u32 {
    return min(u32(distance * PARTS + 0.5), u32(PARTS));
}

// The square of what `counted` gives, times a weight: the low word and the high one.
fn weighted_square(distance: u32, weight: u32) -> vec2u {
    let high = distance >> 10u;
    let low = distance & 1023u;
    // Each of the three products of ten or eleven bits, twice, and a weight fits into a word.
    let a = high * high * weight;
    let b = 2u * high * low * weight;
    let c = low * low * weight;
    var sum = vec2u(c, (a >> 12u) + (b >> 22u));
    for (var k = 0u; k < 2u; k++) {
        let part = select(b << 10u, a << 20u, k == 1u);
        sum = vec2u(sum.x + part, sum.y + select(0u, 1u, sum.x + part < part));
    }
    return sum;
}

// Adds to a sum of 64 bits, the low word first.
fn add_to_scratch(at: u32, value: vec2u) {
    let before = atomicAdd(&scratch[at], value.x);
    let high = value.y + select(0u, 1u, before + value.x < before);
    if (high > 0u) {
        atomicAdd(&scratch[at + 1u], high);
    }
}

fn add_to_map(at: u32, value: vec2u) {
    let before = atomicAdd(&map[at], value.x);
    let high = value.y + select(0u, 1u, before + value.x < before);
    if (high > 0u) {
        atomicAdd(&map[at + 1u], high);
    }
}

// A sum of 64 bits over a weight.
fn over_weight(low: u32, high: u32, weight: u32) -> f32 {
    return (f32(high) * 4294967296.0 + f32(low)) / f32(weight);
}
