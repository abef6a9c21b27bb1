// A texel's record, in words: the nearest and the farthest depth, whose lowest bits hold the mean weight of a fragment; a bit
// for each slice; a count of 16 bits for each slab, two a word.

override SLICES: u32 = 128u;
override SLABS: u32 = 8u;
// Slices of a slab, as a power of two.
override SLAB_SHIFT: u32 = 4u;

// The mean weight less 1023, in 1..425, has nine bits; a depth within 0 and 1 leaves its two highest bits free and can spare
// three of its lowest: 2^-20 of it.
const SPARE: u32 = 5u;

fn record_of(texel: u32) -> u32 {
    return texel * (2u + SLICES / 32u + SLABS / 2u);
}

// Where the counts of a record begin.
fn counts_of(record: u32) -> u32 {
    return record + 2u + SLICES / 32u;
}

// The slice of a depth within a texel's range as a whole and a broken part.
fn slice_of(near: f32, far: f32, depth: f32) -> vec2f {
    let slices = f32(SLICES);
    // With one fragment, or all at one depth, there is no range and this is no number, or infinite: any slice will do.
    var part = (depth - near) * (1.0 / (far - near));
    part = select(0.0, part, part > 0.0);
    part = select(1.0, part, part < 1.0) * slices;
    // The end of the range belongs to the last slice.
    let slice = min(floor(part), slices - 1.0);
    return vec2f(slice, part - slice);
}
