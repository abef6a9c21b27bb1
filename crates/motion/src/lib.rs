//! Bodies and motion: glTF, BVH, retargeting, the pose at a time and its colliders.
