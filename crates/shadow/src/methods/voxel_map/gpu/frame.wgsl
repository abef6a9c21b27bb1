// The placement of the cells of a map. Twin of `VoxelUniform` in gpu/mod.rs.

struct VoxelUniform {
    // World space; w is what a segment whose length across the light is one cell, or a point, adds to its cell, in fixed point.
    anchor: vec4f,
    // Axes in cells, one along the light and two across it; w is the first cell of the window.
    along: vec4f,
    row: vec4f,
    column: vec4f,
    // Cells along each edge, segments, points, 1 for the filter as printed.
    size: vec4u,
}

@group(0) @binding(0) var<uniform> voxels: VoxelUniform;

// Coordinates in the window, in cells: along the light, then across it.
fn window_from_world(p: vec3f) -> vec3f {
    let d = p - voxels.anchor.xyz;
    return vec3f(
        (d.x * voxels.along.x + d.y * voxels.along.y) + d.z * voxels.along.z,
        (d.x * voxels.row.x + d.y * voxels.row.y) + d.z * voxels.row.z,
        (d.x * voxels.column.x + d.y * voxels.column.y) + d.z * voxels.column.z,
    ) - vec3f(voxels.along.w, voxels.row.w, voxels.column.w);
}

// Cells are stored slice by slice along the light, so that threads of neighbouring columns access neighbouring words.
fn cell_at(cell: vec3u) -> u32 {
    return (cell.x * voxels.size.x + cell.y) * voxels.size.x + cell.z;
}
