// The record of a pixel, in words: the farthest depth, with inverted bits so that 0 means none, and the nearest depth; one bit for
// each of 128 slices of the distances between; the optical depth in units of 2^-16 of each of 8 slabs of 16 slices, or after the
// sums pass of all slabs up to it; and the weighted light in units of 2^-14, with the sum of the weights. Twin of
// cpu/transparency/occupancy.rs.

const RECORD_WORDS: u32 = 18u;
const BITS_AT: u32 = 2u;
const SLABS_AT: u32 = 6u;
const LIGHT_AT: u32 = 14u;
const SLICES: f32 = 128.0;
const DEPTH_ONE: f32 = 65536.0;
const MAX_DEPTH: f32 = 16.0;
const LIGHT_ONE: f32 = 16384.0;

// Depth falls with distance; its inverse is distance up to a factor.
fn distance_of(depth: f32) -> f32 {
    return 1.0 / max(depth, 1e-9);
}

// The position of a distance between the nearest and the farthest: slice index and fraction.
fn slice_of(record: u32, depth: f32) -> f32 {
    let near = distance_of(bitcast<f32>(atomicLoad(&map[record])));
    let far = distance_of(bitcast<f32>(~atomicLoad(&map[record + 1u])));
    let slice = (distance_of(depth) - near) / (far - near) * SLICES;
    return select(0.0, clamp(slice, 0.0, SLICES), far > near);
}

fn optical_depth(alpha: f32) -> f32 {
    return select(MAX_DEPTH, min(-log(1.0 - alpha), MAX_DEPTH), alpha < 1.0);
}
