// What passes write. Everything is 0 when a build begins.

@group(0) @binding(3) var<storage, read_write> map: array<atomic<u32>>;
// Needed while the map is made, and by all lights in turn.
@group(0) @binding(4) var<storage, read_write> scratch: array<atomic<u32>>;
