// Allocates the list of each pixel: a workgroup allocates one range for all of its pixels.

var<workgroup> wanted: atomic<u32>;
var<workgroup> begin: u32;

@compute @workgroup_size(64)
fn allocate(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = id.x + id.y * groups.x * 64u;
    var count = 0u;
    if (pixel < area_pixels()) {
        count = atomicLoad(&map[pixel * RECORD_WORDS + 1u]);
    }
    let own = atomicAdd(&wanted, count);
    workgroupBarrier();
    if (local == 0u) {
        let more = atomicLoad(&wanted);
        begin = atomicAdd(&total[0], more);
        // The most that any area needs.
        atomicMax(&total[1], begin + more);
    }
    workgroupBarrier();
    if (pixel < area_pixels()) {
        atomicStore(&map[pixel * RECORD_WORDS], begin + own);
    }
}
