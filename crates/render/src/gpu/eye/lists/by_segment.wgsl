// Fragments are sorted by the distance of their segment's middle.

fn key_of(fragment: Fragment) -> u32 {
    let a = 1.0 / max(shaded[fragment.first].at.z, 1e-9);
    let b = 1.0 / max(shaded[fragment.first + 1u].at.z, 1e-9);
    return ~bitcast<u32>(0.5 * (a + b));
}
