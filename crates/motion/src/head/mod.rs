//! The head: the joint that carries it, and the surface on which hair grows.

mod pick;
mod scalp;
mod surface;

pub use pick::{guess_head, joint_paths};
pub use surface::{HeadMesh, head_mesh};
pub(crate) use surface::{neck_joints, skin_mesh};
