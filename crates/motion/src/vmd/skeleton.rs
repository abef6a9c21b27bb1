//! The skeleton to which the names of a VMD file belong: the standard model of `MikuMikuDance` at rest.
//!
//! A VMD file has no skeleton. Models that share the standard names also share these proportions closely enough: the
//! arms hang at 40 degrees, the figure is 20 units (1.6 m) tall, and stands in the origin.

use glam::Vec3;

/// Metres per unit of `MikuMikuDance`.
pub(super) const UNIT_METRES: f32 = 0.08;

/// A bone at rest.
pub(super) struct Bone {
    /// The name of its joint.
    pub(super) joint: &'static str,
    pub(super) parent: Option<usize>,
    /// Position in units, right-handed with Y up and the face toward +Z; the left is +X.
    pub(super) place: [f32; 3],
    /// The bones of a file whose rotations it performs, one after the other.
    pub(super) names: &'static [&'static str],
}

const fn bone(
    joint: &'static str,
    parent: Option<usize>,
    place: [f32; 3],
    names: &'static [&'static str],
) -> Bone {
    Bone { joint, parent, place, names }
}

/// Places of the legs' joints in [`BONES`]: thigh, shin, foot, toe; left, then right.
pub(super) const LEGS: [[usize; 4]; 2] = [[17, 18, 19, 20], [21, 22, 23, 24]];

/// The bones, parents first. Twist bones are a part of the bone that they twist.
pub(super) const BONES: [Bone; 25] = [
    bone("Root", None, [0.0, 0.0, 0.0], &["全ての親"]),
    bone("Center", Some(0), [0.0, 8.0, 0.0], &["センター"]),
    bone("Groove", Some(1), [0.0, 8.2, 0.0], &["グルーブ"]),
    bone("Waist", Some(2), [0.0, 11.8, 0.0], &["腰"]),
    bone("LowerBody", Some(3), [0.0, 12.2, 0.0], &["下半身"]),
    bone("Spine", Some(3), [0.0, 12.2, 0.0], &["上半身"]),
    bone("Chest", Some(5), [0.0, 13.5, 0.0], &["上半身2"]),
    bone("Neck", Some(6), [0.0, 16.5, 0.0], &["首"]),
    bone("Head", Some(7), [0.0, 17.3, 0.0], &["頭"]),
    bone("LeftShoulder", Some(6), [0.3, 16.1, 0.0], &["左肩P", "左肩"]),
    bone("LeftArm", Some(9), [1.35, 16.0, 0.0], &["左腕", "左腕捩"]),
    bone("LeftForeArm", Some(10), [3.264, 14.393, 0.0], &["左ひじ", "左手捩"]),
    bone("LeftHand", Some(11), [5.026, 12.915, 0.0], &["左手首"]),
    bone("RightShoulder", Some(6), [-0.3, 16.1, 0.0], &["右肩P", "右肩"]),
    bone("RightArm", Some(13), [-1.35, 16.0, 0.0], &["右腕", "右腕捩"]),
    bone("RightForeArm", Some(14), [-3.264, 14.393, 0.0], &["右ひじ", "右手捩"]),
    bone("RightHand", Some(15), [-5.026, 12.915, 0.0], &["右手首"]),
    bone("LeftUpLeg", Some(4), [0.95, 11.0, 0.0], &["左足"]),
    bone("LeftLeg", Some(17), [0.95, 6.1, 0.0], &["左ひざ"]),
    bone("LeftFoot", Some(18), [0.95, 1.2, 0.0], &["左足首"]),
    bone("LeftToeBase", Some(19), [0.95, 0.2, 1.3], &[]),
    bone("RightUpLeg", Some(4), [-0.95, 11.0, 0.0], &["右足"]),
    bone("RightLeg", Some(21), [-0.95, 6.1, 0.0], &["右ひざ"]),
    bone("RightFoot", Some(22), [-0.95, 1.2, 0.0], &["右足首"]),
    bone("RightToeBase", Some(23), [-0.95, 0.2, 1.3], &[]),
];

/// Names of a leg's targets: the ankle's parent, the ankle, the toe; left, then right.
pub(super) const TARGETS: [[&str; 3]; 2] =
    [["左足IK親", "左足IK", "左つま先IK"], ["右足IK親", "右足IK", "右つま先IK"]];

/// The end of the head bone: the crown, units above the joint.
pub(super) const CROWN: Vec3 = Vec3::new(0.0, 2.7, 0.0);

/// Position of a bone at rest, units.
pub(super) fn place(bone: usize) -> Vec3 {
    Vec3::from(BONES[bone].place)
}

/// Position of a bone at rest relative to its parent, units.
pub(super) fn offset(bone: usize) -> Vec3 {
    place(bone) - BONES[bone].parent.map_or(Vec3::ZERO, place)
}
