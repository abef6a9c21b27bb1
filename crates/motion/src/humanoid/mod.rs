//! The roles of the joints of a figure, derived from their names and their tree, and from its shape where names do not tell them.

#[cfg(test)]
mod families;
mod names;
mod shape;

use std::collections::BTreeMap;

use glam::Vec3;

use crate::Skeleton;
use names::{Label, Part, label, labels_of, side_of};
pub(crate) use names::{Side, is_twist};
use shape::Shape;

/// The role of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Role {
    /// Where legs and spine meet; carries the whole figure.
    Hips,
    /// Where the legs meet, if that is another joint than the hips.
    Pelvis,
    /// Where the arms meet.
    Chest,
    Neck,
    Head,
    Clavicle(Side),
    UpperArm(Side),
    Forearm(Side),
    Hand(Side),
    Thigh(Side),
    Shin(Side),
    Foot(Side),
    Toe(Side),
}

impl Role {
    /// Its name in errors.
    pub(crate) fn label(self) -> String {
        let side = |s: Side| if s == Side::Left { "left" } else { "right" };
        match self {
            Self::Hips => "hips".into(),
            Self::Pelvis => "pelvis".into(),
            Self::Chest => "chest".into(),
            Self::Neck => "neck".into(),
            Self::Head => "head".into(),
            Self::Clavicle(s) => format!("{} clavicle", side(s)),
            Self::UpperArm(s) => format!("{} upper arm", side(s)),
            Self::Forearm(s) => format!("{} forearm", side(s)),
            Self::Hand(s) => format!("{} hand", side(s)),
            Self::Thigh(s) => format!("{} thigh", side(s)),
            Self::Shin(s) => format!("{} shin", side(s)),
            Self::Foot(s) => format!("{} foot", side(s)),
            Self::Toe(s) => format!("{} toe", side(s)),
        }
    }
}

/// The role that follows from a name alone.
pub(crate) fn role_of(name: &str) -> Option<Role> {
    label(name).filter(|l| l.part == Part::Head).map(|_| Role::Head)
}

/// The roles of a skeleton's joints.
#[derive(Clone, Debug, Default)]
pub(crate) struct Humanoid {
    joints: BTreeMap<Role, usize>,
    /// Joints between hips and neck, from the bottom.
    pub(crate) spine: Vec<usize>,
    /// Joints of the neck, from the bottom.
    pub(crate) neck: Vec<usize>,
    /// Whether the shape of the skeleton told the roles, because the names do not.
    pub(crate) is_by_shape: bool,
}

impl Humanoid {
    pub(crate) fn of_skeleton(skeleton: &Skeleton) -> Self {
        let names: Vec<&str> = if skeleton.named.is_empty() {
            skeleton.joints.iter().map(|j| j.name.as_str()).collect()
        } else {
            (0..skeleton.joints.len()).map(|j| skeleton.named.get(&j).map_or("", String::as_str)).collect()
        };
        Self::new(&names, &skeleton.joints.iter().map(|j| j.parent).collect::<Vec<_>>())
    }

    /// As [`Humanoid::of_skeleton`], by the shape where names do not tell the roles.
    pub(crate) fn of_any_skeleton(skeleton: &Skeleton) -> Self {
        let places: Vec<Vec3> = (0..skeleton.joints.len()).map(|j| skeleton.rest_position(j)).collect();
        let names: Vec<&str> = skeleton.joints.iter().map(|j| j.name.as_str()).collect();
        let parents: Vec<Option<usize>> = skeleton.joints.iter().map(|j| j.parent).collect();
        Self::of_skeleton(skeleton).or_by_shape(&names, &parents, &places)
    }

    /// The roles by the shape of a skeleton with joints at `places`, if these roles are not those of a whole figure.
    pub(crate) fn or_by_shape(self, names: &[&str], parents: &[Option<usize>], places: &[Vec3]) -> Self {
        if self.is_whole(parents) {
            return self;
        }
        let roles = Shape::new(parents, places).roles(&|joint| side_of(names[joint]));
        if roles.is_empty() {
            return self;
        }
        let mut figure = Self { joints: roles.into_iter().collect(), is_by_shape: true, ..Self::default() };
        figure.complete(&labels_of(names), parents);
        figure
    }

    /// Whether all limbs have their roles, each below the one that it belongs to.
    fn is_whole(&self, parents: &[Option<usize>]) -> bool {
        let depth = depths(parents);
        let is_limb = |upper: Role, lower: Role| match (self.get(upper), self.get(lower)) {
            (Some(upper), Some(lower)) => {
                upper != lower && common_ancestor(parents, &depth, upper, lower) == Some(upper)
            }
            _ => false,
        };
        self.get(Role::Hips).is_some()
            && self.get(Role::Head).is_some()
            && Side::BOTH.into_iter().all(|side| {
                is_limb(Role::Thigh(side), Role::Shin(side))
                    && is_limb(Role::UpperArm(side), Role::Forearm(side))
            })
    }

    /// The joint of a role.
    pub(crate) fn get(&self, role: Role) -> Option<usize> {
        self.joints.get(&role).copied()
    }

    /// All roles that were found.
    pub(crate) fn roles(&self) -> impl Iterator<Item = (Role, usize)> {
        self.joints.iter().map(|(&role, &joint)| (role, joint))
    }

    /// Finds the roles of joints by their names and parents.
    pub(crate) fn new(names: &[&str], parents: &[Option<usize>]) -> Self {
        let mut labels = labels_of(names);
        // Of a whole rig of Rigify only the joints that deform the surface are a figure; the rest are controls.
        let deforms = |name: &str| name.starts_with("DEF-");
        if names.iter().filter(|name| deforms(name)).count() >= 10 {
            for (label, _) in labels.iter_mut().zip(names).filter(|(_, name)| !deforms(name)) {
                *label = None;
            }
        }
        let depth = depths(parents);
        // A joint of a limb that carries a further one is no helper, such as `elbow_l` at the end of `lowerarm_l`.
        let carries = carrying(&labels, parents);
        // The best joint for a part: not a helper, one that carries the rest of the limb, the lowest number, then the deepest
        // (`LHipJoint` above `LeftHip`).
        let best = |parts: &[Part], side: Option<Side>| {
            parts.iter().find_map(|&part| {
                (0..names.len())
                    .filter(|&j| labels[j].as_ref().is_some_and(|l| l.part == part && l.side == side))
                    .min_by(|&a, &b| {
                        let key = |j: usize| {
                            let l = labels[j].as_ref();
                            let order = l.map(|l| (l.helper, !carries[j], l.numbers.clone()));
                            (order, std::cmp::Reverse(depth[j]), j)
                        };
                        key(a).cmp(&key(b))
                    })
            })
        };
        let is_below = |joint: Option<usize>, above: Option<usize>| match (joint, above) {
            (Some(joint), Some(above)) => {
                joint != above && common_ancestor(parents, &depth, joint, above) == Some(above)
            }
            _ => false,
        };
        // The joint at the end of a limb has one of two names, or is the upper of two joints with both.
        let end_of_limb = |joint: Option<usize>, extremity: Option<usize>| {
            if is_below(joint, extremity) { extremity } else { joint.or(extremity) }
        };
        let mut joints = BTreeMap::new();
        let mut put = |role: Role, joint: Option<usize>| {
            if let Some(joint) = joint {
                joints.insert(role, joint);
            }
        };
        put(Role::Head, best(&[Part::Head], None));
        for side in Side::BOTH {
            let s = Some(side);
            let has_upper_arm = best(&[Part::UpperArm], s).is_some();
            let shoulder = if has_upper_arm { Part::Clavicle } else { Part::UpperArm };
            put(Role::UpperArm(side), best(&[Part::UpperArm, Part::Shoulder], s));
            put(
                Role::Clavicle(side),
                best(
                    if shoulder == Part::Clavicle {
                        &[Part::Clavicle, Part::Shoulder]
                    } else {
                        &[Part::Clavicle]
                    },
                    s,
                ),
            );
            put(Role::Forearm(side), best(&[Part::Forearm], s));
            put(Role::Hand(side), end_of_limb(best(&[Part::Wrist], s), best(&[Part::Hand], s)));
            let has_thigh = best(&[Part::Thigh], s).is_some();
            put(Role::Thigh(side), best(&[Part::Thigh, Part::Leg], s));
            put(Role::Shin(side), best(if has_thigh { &[Part::Shin, Part::Leg] } else { &[Part::Shin] }, s));
            // In some families the foot is what carries the toes, below the ankle; in others it is the ankle.
            let (ankle, foot, toe) = (best(&[Part::Ankle], s), best(&[Part::Foot], s), best(&[Part::Toe], s));
            let heel = best(&[Part::Heel], s)
                .filter(|&heel| is_below(foot, Some(heel)) || foot.is_none() && is_below(toe, Some(heel)));
            let ankle = ankle.or(heel);
            put(Role::Foot(side), end_of_limb(ankle, foot));
            put(Role::Toe(side), if is_below(foot, ankle) { foot } else { toe });
        }
        let arms = meet(&joints, parents, Role::UpperArm);
        if let (None, Some(arms)) = (joints.get(&Role::Head), arms)
            && let Some(head) = end_of_spine(&labels, parents, arms)
        {
            joints.insert(Role::Head, head);
        }
        let neck = best(&[Part::Neck], None);
        let head = joints.get(&Role::Head).copied().or(neck);
        let legs = meet(&joints, parents, Role::Thigh);
        let trunk = legs.zip(head).and_then(|(legs, head)| common_ancestor(parents, &depth, legs, head));
        if let Some(hips) = trunk.or_else(|| best(&[Part::Hips], None)) {
            joints.insert(Role::Hips, hips);
        }
        let mut figure = Self { joints, ..Self::default() };
        figure.complete(&labels, parents);
        if let (None, Some(hips), Some(neck)) = (figure.get(Role::Head), figure.get(Role::Hips), neck) {
            figure.split_trunk(&labels, parents, hips, neck);
        }
        figure
    }

    /// Adds the roles of the trunk that follow from those of the limbs, hips and head.
    fn complete(&mut self, labels: &[Option<Label>], parents: &[Option<usize>]) {
        let hips = self.get(Role::Hips);
        if let Some(legs) = meet(&self.joints, parents, Role::Thigh).filter(|&legs| Some(legs) != hips) {
            self.joints.insert(Role::Pelvis, legs);
        }
        if let Some(arms) = meet(&self.joints, parents, Role::UpperArm) {
            self.joints.insert(Role::Chest, arms);
        }
        if let (Some(hips), Some(head)) = (hips, self.get(Role::Head)) {
            self.split_trunk(labels, parents, hips, head);
        }
    }

    /// Splits the joints between hips and head into spine and neck.
    fn split_trunk(&mut self, labels: &[Option<Label>], parents: &[Option<usize>], hips: usize, head: usize) {
        let mut path = Vec::new();
        let mut at = parents[head];
        while let Some(j) = at.filter(|&j| j != hips) {
            path.push(j);
            at = parents[j];
        }
        path.reverse();
        if at.is_none() {
            return;
        }
        let is_neck = |j: &usize| labels[*j].as_ref().is_some_and(|l| l.part == Part::Neck);
        // Everything above the arms is neck. If the arms are unknown, a name decides, or else the last joint. Arms that hang on the neck
        // itself (3ds Max) make it no part of the chest.
        let chest = self.get(Role::Chest).and_then(|c| path.iter().position(|&j| j == c));
        let split = match chest {
            Some(c) if is_neck(&path[c]) => {
                self.joints.insert(Role::Chest, if c > 0 { path[c - 1] } else { hips });
                c
            }
            Some(c) => c + 1,
            None => path.iter().position(is_neck).unwrap_or(path.len().saturating_sub(1)),
        };
        self.neck = path.split_off(split);
        self.spine = path;
        if let Some(&neck) = self.neck.iter().find(|j| is_neck(j)).or(self.neck.first()) {
            self.joints.insert(Role::Neck, neck);
        }
    }
}

/// Whether each joint has one below it that names another part of the same limb.
fn carrying(labels: &[Option<Label>], parents: &[Option<usize>]) -> Vec<bool> {
    let mut carries = vec![false; labels.len()];
    for label in labels.iter().enumerate().filter_map(|(j, label)| Some((j, label.as_ref()?))) {
        let (joint, part, side) = (label.0, label.1.part, label.1.side);
        let mut at = parents[joint].filter(|_| side.is_some());
        while let Some(j) = at {
            carries[j] |= labels[j].as_ref().is_some_and(|above| above.side == side && above.part != part);
            at = parents[j];
        }
    }
    carries
}

/// The last joint of a spine whose joints are numbered from the hips to the head, if it goes on by two above the arms.
fn end_of_spine(labels: &[Option<Label>], parents: &[Option<usize>], arms: usize) -> Option<usize> {
    let is_spine = |j: usize| labels[j].as_ref().is_some_and(|l| l.part == Part::Spine && l.side.is_none());
    let above = |mut j: usize| {
        let mut joints = 0;
        while let Some(parent) = parents[j] {
            joints += usize::from(is_spine(j));
            if parent == arms {
                return Some(joints);
            }
            j = parent;
        }
        None
    };
    let of_spine = (0..labels.len()).filter(|&j| is_spine(j));
    let (joints, head) = of_spine.filter_map(|j| Some((above(j)?, j))).max()?;
    (joints >= 2).then_some(head)
}

/// The joint in which the limbs of both sides meet.
fn meet(
    joints: &BTreeMap<Role, usize>,
    parents: &[Option<usize>],
    role: impl Fn(Side) -> Role,
) -> Option<usize> {
    let [left, right] = Side::BOTH.map(|side| joints.get(&role(side)).copied());
    common_ancestor(parents, &depths(parents), left?, right?)
}

fn depths(parents: &[Option<usize>]) -> Vec<usize> {
    let mut depth = Vec::with_capacity(parents.len());
    for parent in parents {
        let d = parent.map_or(0, |p| depth[p] + 1);
        depth.push(d);
    }
    depth
}

/// The lowest common ancestor, which may be one of the two.
fn common_ancestor(parents: &[Option<usize>], depth: &[usize], mut a: usize, mut b: usize) -> Option<usize> {
    while a != b {
        if depth[a] >= depth[b] {
            a = parents[a]?;
        } else {
            b = parents[b]?;
        }
    }
    Some(a)
}
