//! The skeleton: names, parents and rest positions of the joints.
//!
//! At rest the axes of every joint are the world's axes, so the rotation of a joint is relative to the rest pose.

use glam::Vec3;

/// Where the joints of a figure are, world space at rest, metres; limbs of the left side.
pub(super) struct Landmarks {
    /// The pelvis.
    pub(super) hips: Vec3,
    /// The back, from below.
    pub(super) back: [Vec3; 3],
    /// The lower end of the neck.
    pub(super) neck: Vec3,
    /// Where the skull turns.
    pub(super) head: Vec3,
    /// Collar bone, shoulder, elbow and wrist.
    pub(super) arm: [Vec3; 4],
    /// Hip, knee, ankle and ball of the foot.
    pub(super) leg: [Vec3; 4],
}

/// A skeleton, and what the choreography needs to know about it.
pub(super) struct Rig {
    /// The joints, parents first.
    pub(super) joints: Vec<RigJoint>,
    /// The direction of the palm of the left hand at rest.
    pub(super) palm: Vec3,
}

/// Height of the hip joint on the figure for which the choreography was written, metres.
const USUAL_HIP: f32 = 0.885;

/// Where the joint sits that takes half of the hand's twist, as a fraction of the forearm.
const FOREARM_TWIST_AT: f32 = 0.65;

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
/// Offset of the joint that has a part of the hand's twist.
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

impl Rig {
    /// The skeleton on these landmarks.
    pub(super) fn new(at: &Landmarks, palm: Vec3) -> Self {
        let mut joints = Vec::new();
        let mut add = |name: String, parent: Option<usize>, rest: Vec3| {
            joints.push(RigJoint { name, parent, rest });
            joints.len() - 1
        };
        let hips = add("hips".into(), None, at.hips);
        let spine = add("spine".into(), Some(hips), at.back[0]);
        let spine_1 = add("spine_1".into(), Some(spine), at.back[1]);
        let chest = add("chest".into(), Some(spine_1), at.back[2]);
        let neck = add("neck".into(), Some(chest), at.neck);
        add("head".into(), Some(neck), at.head);
        for (side, sign) in [("l", 1.0), ("r", -1.0)] {
            let [collar, shoulder, elbow, wrist] = at.arm.map(|p| p * Vec3::new(sign, 1.0, 1.0));
            let collar = add(format!("clavicle_{side}"), Some(chest), collar);
            let upper = add(format!("upper_arm_{side}"), Some(collar), shoulder);
            add(format!("upper_arm_twist_{side}"), Some(upper), shoulder);
            let fore = add(format!("forearm_{side}"), Some(upper), elbow);
            add(format!("forearm_twist_{side}"), Some(fore), elbow.lerp(wrist, FOREARM_TWIST_AT));
            add(format!("hand_{side}"), Some(fore), wrist);
        }
        for (side, sign) in [("l", 1.0), ("r", -1.0)] {
            let [hip, knee, ankle, ball] = at.leg.map(|p| p * Vec3::new(sign, 1.0, 1.0));
            let thigh = add(format!("thigh_{side}"), Some(hips), hip);
            add(format!("thigh_twist_{side}"), Some(thigh), hip);
            let shin = add(format!("shin_{side}"), Some(thigh), knee);
            let foot = add(format!("foot_{side}"), Some(shin), ankle);
            add(format!("toe_{side}"), Some(foot), ball);
        }
        Self { joints, palm }
    }

    /// The size of the figure as a multiple of that for which the choreography was written.
    pub(super) fn scale(&self) -> f32 {
        self.joints[THIGH].rest.y / USUAL_HIP
    }

    /// Fraction of the hand's twist that its twist joint takes over.
    pub(super) fn forearm_twist(&self) -> f32 {
        let at = |offset: usize| self.joints[CLAVICLE + offset].rest;
        at(FOREARM).distance(at(FOREARM_TWIST)) / at(FOREARM).distance(at(HAND))
    }
}
