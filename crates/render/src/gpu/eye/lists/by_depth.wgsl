// Fragments are sorted by their own depth.

fn key_of(fragment: Fragment) -> u32 {
    return bitcast<u32>(fragment.depth);
}
