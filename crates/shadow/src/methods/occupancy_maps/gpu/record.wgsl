// A record consists of words: the nearest and the farthest depth and the mean weight of a fragment (floats); one bit per slice; one
// 16-bit count per slab, two per word. The three lowest bits of both depths are 0: the range is rounded outward.

override SLICES: u32 = 128u;
override SLABS: u32 = 8u;
// Base-2 logarithm of the slices per slab.
override SLAB_SHIFT: u32 = 4u;

// Words before the bits.
const HEADER: u32 = 3u;

fn record_of(texel: u32) -> u32 {
    return texel * (HEADER + SLICES / 32u + SLABS / 2u);
}

// The first word of the counts of a record.
fn counts_of(record: u32) -> u32 {
    return record + HEADER + SLICES / 32u;
}

// The slice of a depth within a texel's range: integer part and fraction.
fn slice_of(near: f32, far: f32, depth: f32) -> vec2f {
    let slices = f32(SLICES);
    // With one fragment, or all at one depth, the range is empty and this is NaN or infinite: any slice will do.
    var part = (depth - near) * (1.0 / (far - near));
    part = select(0.0, part, part > 0.0);
    part = select(1.0, part, part < 1.0) * slices;
    // The end of the range belongs to the last slice.
    let slice = min(floor(part), slices - 1.0);
    return vec2f(slice, part - slice);
}
