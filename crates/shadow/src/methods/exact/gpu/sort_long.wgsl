// Sorts the fragments of texels with many. All threads of a workgroup cooperate on its 64 texels, one after another; weights
// become running sums.
//
// Loops are unrolled by four: Mesa's llvmpipe ends the loops of a shader after 65,535 iterations in all, which is then enough
// for 500,000 fragments in the long lists of these texels.

const GROUP: u32 = 256u;
const AT_ONCE: u32 = 4u;

var<workgroup> lists: array<vec2u, 64>;
var<workgroup> longest: atomic<u32>;
var<workgroup> sums: array<u32, 256>;

// Orders two fragments of a list if both exist.
fn compare(list_at: vec2u, low: u32, high: u32) {
    if (high >= list_at.y) {
        return;
    }
    let a = list[list_at.x + low];
    let b = list[list_at.x + high];
    if (lies_before(b, a)) {
        list[list_at.x + low] = b;
        list[list_at.x + high] = a;
    }
}

// Pair `pair` of a stage that merges runs of `1 << shift`: the first fragment with the last, and so on.
fn compare_mirrored(list_at: vec2u, pair: u32, shift: u32) {
    let run = (pair >> shift) << (shift + 1u);
    let place = pair & ((1u << shift) - 1u);
    compare(list_at, run + place, run + (2u << shift) - 1u - place);
}

// Pair `pair` of a stage whose fragments are `1 << shift` apart.
fn compare_apart(list_at: vec2u, pair: u32, shift: u32) {
    let low = ((pair >> shift) << (shift + 1u)) + (pair & ((1u << shift) - 1u));
    compare(list_at, low, low + (1u << shift));
}

// A bitonic sort (Batcher 1968) in the form in which every comparison puts the smaller item first, so that items beyond the end
// need no storage.
fn sort_together(list_at: vec2u, local: u32) {
    // Pairs of the next power of two.
    let bits = 32u - countLeadingZeros(list_at.y - 1u);
    let pairs = 1u << (bits - 1u);
    for (var merged = 0u; merged < bits; merged++) {
        for (var pair = local; pair < pairs; pair += GROUP * AT_ONCE) {
            compare_mirrored(list_at, pair, merged);
            compare_mirrored(list_at, pair + GROUP, merged);
            compare_mirrored(list_at, pair + 2u * GROUP, merged);
            compare_mirrored(list_at, pair + 3u * GROUP, merged);
        }
        storageBarrier();
        for (var apart = merged; apart > 0u; apart--) {
            for (var pair = local; pair < pairs; pair += GROUP * AT_ONCE) {
                compare_apart(list_at, pair, apart - 1u);
                compare_apart(list_at, pair + GROUP, apart - 1u);
                compare_apart(list_at, pair + 2u * GROUP, apart - 1u);
                compare_apart(list_at, pair + 3u * GROUP, apart - 1u);
            }
            storageBarrier();
        }
    }
}

// Each thread sums one piece, adds the sums of the pieces before, and writes running sums.
fn sum_together(list_at: vec2u, local: u32) {
    let piece = (list_at.y + GROUP - 1u) / GROUP;
    let first = min(local * piece, list_at.y);
    let end = min(first + piece, list_at.y);
    var sum = 0u;
    for (var i = first; i < end; i++) {
        sum = sum_of(sum, list[list_at.x + i].y);
    }
    sums[local] = sum;
    workgroupBarrier();
    sum = 0u;
    for (var before = 0u; before < local; before++) {
        sum = sum_of(sum, sums[before]);
    }
    for (var i = first; i < end; i++) {
        sum = sum_of(sum, list[list_at.x + i].y);
        list[list_at.x + i].y = sum;
    }
    workgroupBarrier();
}

@compute @workgroup_size(256)
fn each_group(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let texel = (group.x + group.y * groups.x) * 64u + local;
    if (local < 64u) {
        lists[local] = vec2u(0u);
        if (texel < texels.count) {
            lists[local] = list_of(texel);
            atomicMax(&longest, lists[local].y);
        }
    }
    workgroupBarrier();
    if (workgroupUniformLoad(&longest) <= LONG) {
        return;
    }
    for (var i = 0u; i < 64u; i++) {
        let list_at = workgroupUniformLoad(&lists[i]);
        if (list_at.y > LONG) {
            sort_together(list_at, local);
            sum_together(list_at, local);
        }
    }
}
