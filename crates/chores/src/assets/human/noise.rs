//! Smooth random values over space, the same in every run.

use glam::{IVec3, Vec3};

/// A value of -1 to 1 that varies over about one unit.
pub(super) fn noise(p: Vec3) -> f32 {
    let cell = p.floor();
    let t = p - cell;
    let t = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let cell = cell.as_ivec3();
    let mut sum = 0.0;
    for i in 0..8_i32 {
        let corner = IVec3::new(i & 1, (i >> 1) & 1, (i >> 2) & 1);
        let weight = |k: usize| if corner[k] == 1 { t[k] } else { 1.0 - t[k] };
        sum += weight(0) * weight(1) * weight(2) * value(cell + corner);
    }
    sum
}

/// The value at a corner of the grid.
fn value(at: IVec3) -> f32 {
    let mut h = (at.x as u32).wrapping_mul(0x8da6_b343)
        ^ (at.y as u32).wrapping_mul(0xd816_3841)
        ^ (at.z as u32).wrapping_mul(0xcb1a_b31f);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^= h >> 15;
    h as f32 / u32::MAX as f32 * 2.0 - 1.0
}
