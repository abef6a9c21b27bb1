//! The skeleton: names, parents and rest positions of the joints.
//!
//! At rest the axes of every joint are the world's axes, so the rotation of a joint is relative to the rest pose.

use glam::Vec3;

/// Landmarks of the rest pose that the figure and the skeleton share, metres, left side.
pub(super) mod rest {
    use glam::Vec3;

    /// Centre of the shoulder joint.
    pub(crate) const SHOULDER: Vec3 = Vec3::new(0.1560, 1.3640, -0.0200);
    /// Centre of the elbow: 0.285 m from the shoulder, 42 degrees below the horizontal.
    pub(crate) const ELBOW: Vec3 = Vec3::new(0.3678, 1.1733, -0.0200);
    /// Centre of the wrist: 0.238 m from the elbow, a little to the front.
    pub(crate) const WRIST: Vec3 = Vec3::new(0.5426, 1.0159, 0.0120);
    /// Hip joint.
    pub(crate) const HIP: Vec3 = Vec3::new(0.0860, 0.8850, 0.0000);
    /// Knee joint.
    pub(crate) const KNEE: Vec3 = Vec3::new(0.0820, 0.4750, 0.0060);
    /// Ankle joint.
    pub(crate) const ANKLE: Vec3 = Vec3::new(0.0762, 0.0780, -0.0320);
    /// Ball of the foot, where the toes bend.
    pub(crate) const TOE: Vec3 = Vec3::new(0.0922, 0.0180, 0.0820);

    /// Unit direction of the upper arm.
    pub(crate) fn upper_arm_direction() -> Vec3 {
        (ELBOW - SHOULDER).normalize_or(Vec3::X)
    }

    /// Unit direction of the forearm.
    pub(crate) fn forearm_direction() -> Vec3 {
        (WRIST - ELBOW).normalize_or(Vec3::X)
    }

    /// Unit direction of the foot, turned out by 8 degrees.
    pub(crate) fn foot_direction() -> Vec3 {
        let (s, c) = 8.0_f32.to_radians().sin_cos();
        Vec3::new(s, 0.0, c)
    }
}

/// A joint of the dancer.
pub(super) struct RigJoint {
    /// Its name in the file.
    pub(super) name: String,
    /// Index of its parent, smaller than its own.
    pub(super) parent: Option<usize>,
    /// Its position at rest, in world space, in metres.
    pub(super) rest: Vec3,
}

/// Index of the pelvis.
pub(super) const HIPS: usize = 0;
/// Index of the lowest joint of the back.
pub(super) const SPINE: usize = 1;
/// Index of the middle joint of the back.
pub(super) const SPINE_1: usize = 2;
/// Index of the ribs.
pub(super) const CHEST: usize = 3;
/// Index of the neck.
pub(super) const NECK: usize = 4;
/// Index of the head.
pub(super) const HEAD: usize = 5;
/// Index of the left collar bone; the limb's other joints follow in the order of these constants.
pub(super) const CLAVICLE: usize = 6;
/// Offset of the upper arm from the collar bone.
pub(super) const UPPER_ARM: usize = 1;
/// Offset of the joint that takes half of the upper arm's twist back.
pub(super) const UPPER_ARM_TWIST: usize = 2;
/// Offset of the forearm.
pub(super) const FOREARM: usize = 3;
/// Offset of the joint that has half of the hand's twist.
pub(super) const FOREARM_TWIST: usize = 4;
/// Offset of the hand.
pub(super) const HAND: usize = 5;
/// Index of the left thigh.
pub(super) const THIGH: usize = 18;
/// Offset of the joint that takes half of the thigh's twist back.
pub(super) const THIGH_TWIST: usize = 1;
/// Offset of the shin.
pub(super) const SHIN: usize = 2;
/// Offset of the foot.
pub(super) const FOOT: usize = 3;
/// Offset of the toes.
pub(super) const TOES: usize = 4;
/// Joints of one arm and of one leg: the right limb follows the left one by as many.
pub(super) const ARM_JOINTS: usize = 6;
/// Joints of one leg.
pub(super) const LEG_JOINTS: usize = 5;

/// The joints, parents first.
pub(super) fn joints() -> Vec<RigJoint> {
    let mut joints = Vec::new();
    let mut add = |name: String, parent: Option<usize>, rest: Vec3| {
        joints.push(RigJoint { name, parent, rest });
        joints.len() - 1
    };
    let v = Vec3::new;
    let spine_y = [(0.930, 0.000), (1.020, -0.012), (1.120, -0.020), (1.230, -0.028)];
    let hips = add("hips".into(), None, v(0.0, 0.930, 0.0));
    let spine = add("spine".into(), Some(hips), v(0.0, spine_y[1].0, spine_y[1].1));
    let spine_1 = add("spine_1".into(), Some(spine), v(0.0, spine_y[2].0, spine_y[2].1));
    let chest = add("chest".into(), Some(spine_1), v(0.0, spine_y[3].0, spine_y[3].1));
    let neck = add("neck".into(), Some(chest), v(0.0, 1.430, -0.032));
    add("head".into(), Some(neck), v(0.0, 1.530, -0.010));
    for (side, sign) in [("l", 1.0), ("r", -1.0)] {
        let m = |p: Vec3| v(p.x * sign, p.y, p.z);
        let collar = add(format!("clavicle_{side}"), Some(chest), m(v(0.020, 1.385, 0.0)));
        let upper = add(format!("upper_arm_{side}"), Some(collar), m(rest::SHOULDER));
        add(format!("upper_arm_twist_{side}"), Some(upper), m(rest::SHOULDER));
        let fore = add(format!("forearm_{side}"), Some(upper), m(rest::ELBOW));
        let middle = rest::ELBOW + (rest::WRIST - rest::ELBOW) * 0.5;
        add(format!("forearm_twist_{side}"), Some(fore), m(middle));
        add(format!("hand_{side}"), Some(fore), m(rest::WRIST));
    }
    for (side, sign) in [("l", 1.0), ("r", -1.0)] {
        let m = |p: Vec3| v(p.x * sign, p.y, p.z);
        let thigh = add(format!("thigh_{side}"), Some(hips), m(rest::HIP));
        add(format!("thigh_twist_{side}"), Some(thigh), m(rest::HIP));
        let shin = add(format!("shin_{side}"), Some(thigh), m(rest::KNEE));
        let foot = add(format!("foot_{side}"), Some(shin), m(rest::ANKLE));
        add(format!("toe_{side}"), Some(foot), m(rest::TOE));
    }
    joints
}
