// Adds the share of a fragment to the moments of its texel.

fn put(texel: u32, depth: f32, weight: u32) {
    let ends = ends_of(texel);
    let z = warped(ends.x, ends.y, depth);
    var power = share_of(texel, weight);
    let first = sums_of(texel);
    for (var k = 0u; k < 4u; k++) {
        power *= z;
        // Sums of integers of both signs wrap around as they should.
        atomicAdd(&scratch[first + k], bitcast<u32>(i32(round(power))));
    }
}
