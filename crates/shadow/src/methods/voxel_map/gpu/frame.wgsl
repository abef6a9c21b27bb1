// The placement of the cells of a map. Twin of `VoxelUniform` in gpu/mod.rs.

struct VoxelUniform {
    // World space.
    anchor: vec3f,
    // What a segment whose length across the light is one cell, or a point, adds to its cell, in fixed point.
    deposit: f32,
    // Axes in cells, one along the light and two across it, and the first cell of the window.
    along: vec3f,
    first_along: f32,
    row: vec3f,
    first_row: f32,
    column: vec3f,
    first_column: f32,
    // Cells along each edge.
    edge: u32,
    segments: u32,
    points: u32,
    // CENTRED, AS_PRINTED or CLOSEST.
    reads: u32,
    // Factors on the squared lengths of a piece of strand along the light and across it.
    squares: vec2f,
    // Of projected strands: distance of the plane, and distance from the light of depth 0, metres.
    plane: f32,
    start: f32,
}

// How points read cells. Twin of `VoxelFilter`.
const CENTRED: u32 = 0u;
const AS_PRINTED: u32 = 1u;
const CLOSEST: u32 = 2u;

// Whether strands are projected from a light: then the fourth coordinate of a point is a factor on the width of its strand, and points
// are projected before they are looked up.
override PROJECTED: bool = false;

@group(0) @binding(0) var<uniform> voxels: VoxelUniform;

// Coordinates in the window, in cells: along the light, then across it.
fn window_from_world(p: vec3f) -> vec3f {
    let d = p - voxels.anchor;
    return vec3f(
        (d.x * voxels.along.x + d.y * voxels.along.y) + d.z * voxels.along.z,
        (d.x * voxels.row.x + d.y * voxels.row.y) + d.z * voxels.row.z,
        (d.x * voxels.column.x + d.y * voxels.column.y) + d.z * voxels.column.z,
    ) - vec3f(voxels.first_along, voxels.first_row, voxels.first_column);
}

// Cells are stored slice by slice along the light, so that threads of neighbouring columns access neighbouring words.
fn cell_at(cell: vec3u) -> u32 {
    return (cell.x * voxels.edge + cell.y) * voxels.edge + cell.z;
}
