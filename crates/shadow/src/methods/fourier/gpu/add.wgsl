// Adds the share of a fragment to the coefficients of its texel.

fn put(texel: u32, depth: f32, weight: u32) {
    let ends = ends_of(texel);
    let share = share_of(texel, weight);
    let one = turn(place_of(ends.x, ends.y, depth));
    var turned = one;
    let first = record_of(texel) + HEADER;
    for (var k = 0u; k < TERMS; k++) {
        let parts = vec2i(round(turned * share));
        // Sums of integers of both signs wrap around as they should.
        atomicAdd(&map[first + 2u * k], bitcast<u32>(parts.x));
        atomicAdd(&map[first + 2u * k + 1u], bitcast<u32>(parts.y));
        turned = turn_on(turned, one);
    }
}
