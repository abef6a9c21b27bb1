// The sort key is the depth of the fragment.

fn key_of(fragment: Fragment) -> u32 {
    return bitcast<u32>(fragment.depth);
}
