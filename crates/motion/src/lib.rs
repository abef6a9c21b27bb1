//! Bodies and motion: glTF, BVH, retargeting, the pose at a time and its colliders.
//!
//! A [`Body`] is immutable and shared by `Arc`. Everything is in metres, right-handed, Y up, the face of the
//! rest pose toward +Z; loaders convert.

mod body;
mod collider;
mod pose;

pub use body::{Body, Joint, Mesh, Skeleton};
pub use collider::{Collider, ColliderShape, PlacedCollider};
pub use pose::Pose;
