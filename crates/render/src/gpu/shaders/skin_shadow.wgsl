// Averages the packed transmittances of the body's vertices over their neighbours: twin of skin.rs.

// Where the neighbours of each vertex begin in the list, and the length of the list.
@group(0) @binding(4) var<uniform> vertices: vec4u;
@group(0) @binding(0) var<storage, read> first: array<u32>;
@group(0) @binding(1) var<storage, read> neighbours: array<u32>;
@group(0) @binding(2) var<storage, read> light_before: array<u32>;
@group(0) @binding(3) var<storage, read_write> light_after: array<u32>;

const EVEN: u32 = 0x00ff00ffu;

// Rounded quotients of both halves of a word.
fn halves(sum: u32, n: u32) -> u32 {
    return ((sum & 0xffffu) + n) / (2u * n) | ((sum >> 16u) + n) / (2u * n) << 16u;
}

@compute @workgroup_size(64)
fn soften(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= vertices.x) {
        return;
    }
    let own = light_before[i];
    let start = first[i];
    let n = first[i + 1u] - start;
    if (n == 0u) {
        light_after[i] = own;
        return;
    }
    var even = n * (own & EVEN);
    var odd = n * ((own >> 8u) & EVEN);
    for (var k = 0u; k < n; k += 1u) {
        let word = light_before[neighbours[start + k]];
        even += word & EVEN;
        odd += (word >> 8u) & EVEN;
    }
    light_after[i] = halves(even, n) | halves(odd, n) << 8u;
}
