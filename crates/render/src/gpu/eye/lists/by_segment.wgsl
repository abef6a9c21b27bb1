// Fragments are sorted by the distance of their segment's middle.

fn key_of(fragment: Fragment) -> u32 {
    return ~bitcast<u32>(fragment.middle);
}
