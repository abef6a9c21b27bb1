// The side of a cube that a vector points at: twice its longest axis, plus 1 if it points backward. Twin of `side_of` in cube.rs.
fn side_of(v: vec3f) -> u32 {
    let a = abs(v);
    if (a.x >= a.y && a.x >= a.z) {
        return select(0u, 1u, v.x < 0.0);
    }
    if (a.y >= a.z) {
        return select(2u, 3u, v.y < 0.0);
    }
    return select(4u, 5u, v.z < 0.0);
}
