// Sums weights along the light, in place.

fn texel_pass(texel: u32) {
    let record = record_of(texel);
    if (atomicLoad(&map[record]) == 0u) {
        return;
    }
    var sum = 0u;
    for (var layer = 1u; layer <= texels.parts; layer++) {
        sum += atomicLoad(&map[record + layer]);
        atomicStore(&map[record + layer], sum);
    }
}
