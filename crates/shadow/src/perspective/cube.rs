//! The sides of a cube around a light that sees too much for one plane.

use glam::Vec3;
use lovelock_gpu::ShaderPart;

use crate::gpu::wgsl;

/// Sides of a cube.
pub const SIDES: usize = 6;

/// `side_of` in shaders.
pub const SHADER: ShaderPart = wgsl!("perspective/", "cube.wgsl");

/// The side of a cube that a vector points at: twice its longest axis, plus 1 if it points backward. Twin of `side_of` in
/// cube.wgsl.
pub fn side_of(v: Vec3) -> usize {
    let a = v.abs();
    let axis = if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    };
    2 * axis + usize::from(v[axis] < 0.0)
}

/// Coordinates on a side of a cube, the first one outward, of coordinates along the axes.
pub fn turned<T: Copy + std::ops::Neg<Output = T>>(v: [T; 3], side: usize) -> [T; 3] {
    let at = |k: usize| v[(side / 2 + k) % 3];
    if side.is_multiple_of(2) { [at(0), at(1), at(2)] } else { [-at(0), at(2), at(1)] }
}
