// Sums optical depth along the light, in place: a cell becomes the depth at its front face (low 16 bits) and at its back face
// (high 16 bits). Twin of sum.rs.

@group(0) @binding(3) var<storage, read_write> map: array<u32>;
@group(0) @binding(4) var<storage, read> full: array<u32>;

// The value at which sums saturate: above 16 in fixed point.
const MAX: u32 = 1u << 25u;
// Shift from the fixed-point format of density to that of faces.
const FACE_SHIFT: u32 = 8u;

@compute @workgroup_size(64)
fn sum_columns(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let column = id.x + id.y * groups.x * 64u;
    let slice = voxels.edge * voxels.edge;
    if (column >= slice) {
        return;
    }
    var sum = 0u;
    var front = 0u;
    for (var i = 0u; i < voxels.edge; i++) {
        let at = i * slice + column;
        let cell = map[at];
        let wrapped = ((full[at >> 5u] >> (at & 31u)) & 1u) != 0u;
        sum = min(sum + select(min(cell, MAX), MAX, wrapped), MAX);
        let back = min((sum + (1u << (FACE_SHIFT - 1u))) >> FACE_SHIFT, 0xffffu);
        let faces = front | (back << 16u);
        // Most cells are empty and lit.
        if (faces != cell) {
            map[at] = faces;
        }
        front = back;
    }
}
