// Puts each fragment into its pixel's list.

fn take(pixel: u32, fragment: Fragment) {
    let record = pixel * RECORD_WORDS;
    let at = atomicLoad(&map[record]) + atomicAdd(&map[record + 2u], 1u);
    // Where there is too little room the frame is drawn anew.
    if (at < eye.room) {
        let color = min(fragment.color, vec3f(65504.0));
        list[at * FRAGMENT_WORDS] = key_of(fragment);
        list[at * FRAGMENT_WORDS + 1u] = pack2x16float(color.rg);
        list[at * FRAGMENT_WORDS + 2u] = pack2x16float(vec2f(color.b, opacity_of(fragment)));
    }
}
