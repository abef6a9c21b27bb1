// Adds the share of a fragment to the means of its texel.

fn put(texel: u32, depth: f32, weight: u32) {
    let ends = ends_of(texel);
    let z = warped(ends.x, ends.y, depth);
    let share = share_of(texel, weight);
    let first = sums_of(texel);
    let one = turn(z * LAST_TURN);
    var turned = one;
    var before = 1.0;
    var value = z;
    for (var k = 0u; k < 2u * ORDER; k++) {
        if (TURNED) {
            value = select(turned.y, turned.x, (k & 1u) == 0u);
        }
        // Sums of integers of both signs wrap around as they should.
        atomicAdd(&scratch[first + k], bitcast<u32>(i32(round(value * share))));
        if (TURNED) {
            turned = select(turned, turn_on(turned, one), (k & 1u) == 1u);
        } else {
            let next = 2.0 * z * value - before;
            before = value;
            value = next;
        }
    }
}
