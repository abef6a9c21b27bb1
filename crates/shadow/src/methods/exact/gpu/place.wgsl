// Allocates a range of the list for each texel. Texels of a workgroup are adjacent; workgroups have no order. The count of a
// texel becomes the index of its first fragment, which the scatter pass advances.

var<workgroup> counts: array<u32, 64>;
var<workgroup> group_start: u32;

// A saturating sum.
fn sum_of(a: u32, b: u32) -> u32 {
    return select(a + b, 0xffffffffu, a + b < a);
}

@compute @workgroup_size(64)
fn each_group(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let texel = id.x + id.y * groups.x * 64u;
    var own = 0u;
    if (texel < texels.count) {
        own = atomicLoad(&map[texel * 2u + 1u]);
    }
    counts[local] = own;
    workgroupBarrier();
    // Prefix sums (Hillis, Steele 1986).
    for (var reach = 1u; reach < 64u; reach <<= 1u) {
        var sum = counts[local];
        if (local >= reach) {
            sum = sum_of(sum, counts[local - reach]);
        }
        workgroupBarrier();
        counts[local] = sum;
        workgroupBarrier();
    }
    if (local == 63u && counts[63] != 0u) {
        group_start = take(counts[63]);
    }
    workgroupBarrier();
    if (own != 0u) {
        let start = group_start + counts[local] - own;
        atomicStore(&map[texel * 2u], start);
        atomicStore(&map[texel * 2u + 1u], start);
    }
}
