// Writes each fragment into the list of its pixel.

fn take(pixel: u32, fragment: Fragment) {
    let record = pixel * RECORD_WORDS;
    let place = atomicAdd(&map[record + 2u], 1u);
    let at = atomicLoad(&map[record]) + place;
    // If the list is too small, the frame is rendered again. A fragment that was not counted is dropped: two programs may round
    // differently.
    if (place < atomicLoad(&map[record + 1u]) && at < eye.room) {
        let color = min(fragment.color, vec3f(65504.0));
        list[at * FRAGMENT_WORDS] = key_of(fragment);
        list[at * FRAGMENT_WORDS + 1u] = pack2x16float(color.rg);
        list[at * FRAGMENT_WORDS + 2u] = pack2x16float(vec2f(color.b, opacity_of(fragment)));
    }
}
