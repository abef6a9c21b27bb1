// Opacity maps (Kim, Neumann 2001), as an example of a shadow method of one's own.
//
// The depth range of the hair is divided into equal slices. The record of a texel holds the optical depth before the end of each slice,
// in a word per slice. method.toml names the passes and the settings; `slices()` is the setting of that name.
//
// What a method may call: record_load, record_store, record_add, record_max, the same for scratch, depth_of_weight, exp_of_minus, and a
// function per setting. Words are u32; bitcast<u32>(x) and bitcast<f32>(x) store a float in one.

// The slice that contains a depth, and the position in it from 0 to 1; above 1 for depths behind all slices.
fn slice_of(depth: f32) -> vec2f {
    let at = depth * f32(slices());
    let slice = min(floor(at), f32(slices() - 1u));
    return vec2f(slice, at - slice);
}

// The first pass, once for every fragment: `texel` is the texel of the light that it covers, `depth` lies between 0 (the first hair) and
// 1 (the last), and `weight` is its optical depth in whole steps.
fn add_fragment(texel: u32, depth: f32, weight: u32) {
    record_add(texel, u32(slice_of(depth).x), weight);
}

// The second pass, once for every texel: sums the slices along the light.
fn sum_slices(texel: u32) {
    var sum = 0u;
    for (var slice = 0u; slice < slices(); slice++) {
        sum += record_load(texel, slice);
        record_store(texel, slice, sum);
    }
}

// The optical depth of the texel's hair before a depth, which is larger than 1 behind all hair. The light that arrives there is
// e^(-optical depth). Interpolated between the ends of two slices.
fn optical_depth(texel: u32, depth: f32) -> f32 {
    let place = slice_of(depth);
    let slice = u32(place.x);
    var before = 0.0;
    if (slice > 0u) {
        before = depth_of_weight(f32(record_load(texel, slice - 1u)));
    }
    let after = depth_of_weight(f32(record_load(texel, slice)));
    return before + (after - before) * min(place.y, 1.0);
}
