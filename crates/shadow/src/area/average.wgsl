// Adds the transmittance in one sample of a light to that in the others; the last one writes the mean. Twin of map.rs.

struct Average {
    // Points, slot of the light, samples of the light, and the sample that is added.
    count: u32,
    slot: u32,
    samples: u32,
    sample: u32,
    // 1 if the sum over points is wanted.
    sums: u32,
}

const SUM_WORDS: u32 = 256u;

@group(0) @binding(0) var<uniform> average: Average;
// Transmittance in the sample: one word per point, in its lowest byte.
@group(0) @binding(1) var<storage, read> found: array<u32>;
@group(0) @binding(2) var<storage, read_write> totals: array<u32>;
@group(0) @binding(3) var<storage, read_write> answers: array<u32>;
@group(0) @binding(4) var<storage, read_write> sum: array<atomic<u32>>;

@compute @workgroup_size(64)
fn add_sample(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= average.count) {
        return;
    }
    let total = select(totals[i], 0u, average.sample == 0u) + (found[i] & 0xffu);
    totals[i] = total;
    if (average.sample + 1u < average.samples) {
        return;
    }
    let byte = (total + average.samples / 2u) / average.samples;
    if (average.slot == 0u) {
        answers[i] = 0xffffff00u | byte;
    } else {
        let shift = 8u * average.slot;
        answers[i] = (answers[i] & ~(0xffu << shift)) | (byte << shift);
    }
    if (average.sums != 0u) {
        atomicAdd(&sum[(i >> 6u) % SUM_WORDS], byte);
    }
}
