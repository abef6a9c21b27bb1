// A histogram of weights over depth, for the seeds.

fn put(texel: u32, depth: f32, weight: u32) {
    let bin = min(u32(part_of(texel, depth) * f32(HISTOGRAM_BINS)), HISTOGRAM_BINS - 1u);
    atomicAdd(&scratch[sums_of(texel, 0u) + bin], weight);
}
