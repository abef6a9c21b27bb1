//! The head: the joint that carries it, and the surface on which hair grows.

mod pick;
mod scalp;
mod surface;

pub use pick::{guess_head, joint_paths};
pub(crate) use surface::neck_joints;
pub use surface::{HeadMesh, head_mesh};
