// The clusters of a texel. Depths within a texel are fractions of its range, 0 to 1 from the nearest to the farthest fragment,
// so that they keep their precision where the range is short.
//
// Scratch memory of a texel: the inverted bits of the nearest depth, so that 0 means no hair; the farthest depth; then three
// words per cluster, or 32 words of a histogram before clusters have centres. `texels.parts`: clusters.
//
// A record has three words per cluster, which finally hold its bin: start, 1 over the width, weight. Until then the first word
// is the centre of the cluster.

const HISTOGRAM_BINS: u32 = 32u;

// Fixed-point scale of distances: times a weight of up to √2 · 1024 they fit into one word, and squares into two.
const PARTS: f32 = 1048576.0;

// Beyond any depth of a texel.
const NOWHERE: f32 = 2.0;

fn scratch_of(texel: u32) -> u32 {
    return texel * (2u + select(3u * texels.parts, max(3u * texels.parts, HISTOGRAM_BINS), texels.seeds == 2u));
}

// The first word of cluster `j` in scratch memory.
fn sums_of(texel: u32, j: u32) -> u32 {
    return scratch_of(texel) + 2u + 3u * j;
}

// The first word of bin `j` of the record.
fn bin_of(texel: u32, j: u32) -> u32 {
    return 3u * (texel * texels.parts + j);
}

fn is_empty(texel: u32) -> bool {
    return atomicLoad(&scratch[scratch_of(texel)]) == 0u;
}

// Nearest and farthest depth.
fn range_of(texel: u32) -> vec2f {
    let at = scratch_of(texel);
    return vec2f(bitcast<f32>(~atomicLoad(&scratch[at])), bitcast<f32>(atomicLoad(&scratch[at + 1u])));
}

// A depth as a fraction of the texel's range; 0 if the range is empty.
fn part_of(texel: u32, depth: f32) -> f32 {
    let range = range_of(texel);
    let part = (depth - range.x) * (1.0 / (range.y - range.x));
    // NaN becomes 0.
    return min(select(0.0, part, part > 0.0), 1.0);
}

fn centre(texel: u32, j: u32) -> f32 {
    return bitcast<f32>(atomicLoad(&map[bin_of(texel, j)]));
}

fn set_centre(texel: u32, j: u32, part: f32) {
    atomicStore(&map[bin_of(texel, j)], bitcast<u32>(part));
}

// The cluster of a depth, and the border before it; a tie goes to the cluster nearer to the light.
struct Place {
    cluster: u32,
    border: f32,
}

fn place_of(texel: u32, part: f32) -> Place {
    var place = Place(0u, 0.0);
    var last = centre(texel, 0u);
    for (var j = 1u; j < texels.parts; j++) {
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

// A distance of 0 to 1 in fixed point.
fn counted(distance: f32) -> u32 {
    return min(u32(distance * PARTS + 0.5), u32(PARTS));
}

// The square of a result of `counted`, times a weight: low word, high word.
fn weighted_square(distance: u32, weight: u32) -> vec2u {
    let high = distance >> 10u;
    let low = distance & 1023u;
    // Each of the three products of ten- or eleven-bit numbers, doubled, times a weight fits into a word.
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

// Adds to a 64-bit sum; its low word is first.
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

// A 64-bit sum divided by a weight.
fn over_weight(low: u32, high: u32, weight: u32) -> f32 {
    return (f32(high) * 4294967296.0 + f32(low)) / f32(weight);
}
