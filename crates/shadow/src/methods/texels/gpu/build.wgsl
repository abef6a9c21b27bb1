// The buffers that passes write. They are cleared before a build.

@group(0) @binding(3) var<storage, read_write> map: array<atomic<u32>>;
// Needed during a build only; all lights share it.
@group(0) @binding(4) var<storage, read_write> scratch: array<atomic<u32>>;
