// Numbers the bricks that hold hair, in the order of the window, from 1 on. One workgroup.

@group(0) @binding(3) var<storage, read_write> index: array<u32>;
@group(0) @binding(5) var<storage, read_write> list: array<u32>;

var<workgroup> counts: array<u32, 64>;

@compute @workgroup_size(64)
fn place_bricks(@builtin(local_invocation_index) local: u32) {
    let all_bricks = march.bricks.x * march.bricks.y * march.bricks.z;
    let share = (all_bricks + 63u) / 64u;
    let first = min(local * share, all_bricks);
    let last = min(first + share, all_bricks);
    var own = 0u;
    for (var i = first; i < last; i++) {
        own += index[i];
    }
    counts[local] = own;
    workgroupBarrier();
    var number = 0u;
    for (var before = 0u; before < local; before++) {
        number += counts[before];
    }
    for (var i = first; i < last; i++) {
        if (index[i] != 0u) {
            number++;
            index[i] = number;
        }
    }
    if (local == 63u) {
        list[0] = number;
        list[1] = number >> 16u;
    }
}
