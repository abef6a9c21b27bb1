// What the methods share that hold all hair of a texel as one function between the ends of a depth range. Twin of whole.rs.

// Whether the range is that of the whole map.
override OF_MAP: bool = false;

// Words of a record before the function: both ends of the range and the weight of all hair (floats).
const HEADER: u32 = 3u;

// The part of the range before a depth, 0 to 1.
fn part_of(near: f32, far: f32, depth: f32) -> f32 {
    let part = (depth - near) * (1.0 / (far - near));
    // NaN becomes 0.
    let positive = select(0.0, part, part > 0.0);
    return select(1.0, positive, positive < 1.0);
}
