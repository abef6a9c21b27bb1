// The sort key is the distance of the middle of the segment.

fn key_of(fragment: Fragment) -> u32 {
    return ~bitcast<u32>(fragment.middle);
}
