// Sorts keys, then numbers of segments (Batcher 1968, the bitonic network): the order is the same on every device.

struct SortUniform {
    // A power of two.
    count: u32,
    // Blocks of this length are sorted by a pass, every other one backward.
    first_block: u32,
    last_block: u32,
    // The distance of the keys that are compared, where they are far apart.
    reach: u32,
}

@group(0) @binding(7) var<uniform> sorting: SortUniform;
@group(0) @binding(3) var<storage, read_write> keys: array<vec2u>;

fn is_before(a: vec2u, b: vec2u) -> bool {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

@compute @workgroup_size(64)
fn sort_far(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= sorting.count / 2u) {
        return;
    }
    let low = (i / sorting.reach) * 2u * sorting.reach + i % sorting.reach;
    let high = low + sorting.reach;
    let a = keys[low];
    let b = keys[high];
    let is_forward = (low & sorting.last_block) == 0u;
    if (is_before(b, a) == is_forward) {
        keys[low] = b;
        keys[high] = a;
    }
}

var<workgroup> near_keys: array<vec2u, 128>;

// All steps between keys at most 64 apart, in the memory of a workgroup.
@compute @workgroup_size(64)
fn sort_near(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let first = (group.x + group.y * groups.x) * 128u;
    let is_there = first < sorting.count;
    if (is_there) {
        near_keys[local] = keys[first + local];
        near_keys[local + 64u] = keys[first + local + 64u];
    }
    for (var block = sorting.first_block; block <= sorting.last_block; block <<= 1u) {
        for (var reach = min(block >> 1u, 64u); reach > 0u; reach >>= 1u) {
            workgroupBarrier();
            let low = (local / reach) * 2u * reach + local % reach;
            let a = near_keys[low];
            let b = near_keys[low + reach];
            let is_forward = ((first + low) & block) == 0u;
            if (is_before(b, a) == is_forward) {
                near_keys[low] = b;
                near_keys[low + reach] = a;
            }
        }
    }
    workgroupBarrier();
    if (is_there) {
        keys[first + local] = near_keys[local];
        keys[first + local + 64u] = near_keys[local + 64u];
    }
}
