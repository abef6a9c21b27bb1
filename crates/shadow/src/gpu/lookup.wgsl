// Looks up many points in the map of one light. A method's query defines `hair_transmittance`.

struct Lookup {
    // Points, items from one point to the next, slot of the light, 1 if the sum is wanted.
    count: u32,
    stride: u32,
    slot: u32,
    sums: u32,
}

const SUM_WORDS: u32 = 256u;

@group(0) @binding(10) var<uniform> lookup: Lookup;
@group(0) @binding(11) var<storage, read> targets: array<vec4f>;
@group(0) @binding(12) var<storage, read_write> answers: array<u32>;
@group(0) @binding(13) var<storage, read_write> sum: array<atomic<u32>>;

@compute @workgroup_size(64)
fn look_up_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= lookup.count) {
        return;
    }
    let t = hair_transmittance(targets[i * lookup.stride].xyz);
    let byte = u32(clamp(t, 0.0, 1.0) * 255.0 + 0.5);
    if (lookup.slot == 0u) {
        answers[i] = 0xffffff00u | byte;
    } else {
        let shift = 8u * lookup.slot;
        answers[i] = (answers[i] & ~(0xffu << shift)) | (byte << shift);
    }
    if (lookup.sums != 0u) {
        // Spread over many words to reduce contention.
        atomicAdd(&sum[(i >> 6u) % SUM_WORDS], byte);
    }
}
