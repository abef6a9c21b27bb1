//! The head: the joint that carries it, and the surface on which hair grows.

mod pick;
mod scalp;
mod shape;
#[cfg(test)]
mod shape_tests;
mod surface;

pub use pick::{guess_head, joint_paths};
pub(crate) use shape::{ShapedHead, find_head};
pub use surface::{HeadMesh, head_mesh};
pub(crate) use surface::{neck_joints, skin_mesh};
