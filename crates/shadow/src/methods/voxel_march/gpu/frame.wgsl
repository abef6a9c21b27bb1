// The placement of cells and bricks. Twin of `MarchUniform` in gpu/mod.rs.

struct MarchUniform {
    // World space.
    anchor: vec3f,
    // Cells per metre.
    per_cell: f32,
    // The corner of the window, cells from the anchor.
    start: vec3f,
    // What a piece of strand as long as a cell adds, in fixed point.
    each: f32,
    // Bricks of the window along each axis; 0 where nothing was built.
    bricks: vec3u,
    segments: u32,
    // Toward a directional light, or where the light stands.
    light: vec3f,
    // Its radius, metres; negative for a directional light.
    radius: f32,
    // Length of a step, cells.
    step_length: f32,
    // 1 to start each point at a place of its own.
    jitter: u32,
    // Bricks that the list has room for.
    room: u32,
}

@group(0) @binding(0) var<uniform> march: MarchUniform;

// Cells along the edge of a brick, numbers along its edge, and numbers of a brick. Twins of grid.rs.
const BRICK: u32 = 8u;
const STORED: u32 = 9u;
const BRICK_WORDS: u32 = 729u;
// Optical depth 1 of a cell, and the most that one sample adds and that a cell is read as.
const DEPTH_ONE: f32 = 1048576.0;
const MOST: u32 = 33554432u;
// Words before the first brick of the list: their number, twice.
const HEAD: u32 = 4u;

fn window_from_world(p: vec3f) -> vec3f {
    return (p - march.anchor) * march.per_cell - march.start;
}

fn brick_at(brick: vec3u) -> u32 {
    return (brick.z * march.bricks.y + brick.y) * march.bricks.x + brick.x;
}
