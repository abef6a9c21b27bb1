//! The roles of the joints of a figure, derived from their names and their tree.

#[cfg(test)]
mod families;
mod names;

use std::collections::BTreeMap;

use crate::Skeleton;
use names::{Label, Part, label};
pub(crate) use names::{Side, is_twist};

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
        let mut labels: Vec<Option<Label>> = names.iter().map(|n| label(n)).collect();
        // Of a whole rig of Rigify only the joints that deform the surface are a figure; the rest are controls.
        let deforms = |name: &str| name.starts_with("DEF-");
        if names.iter().filter(|name| deforms(name)).count() >= 10 {
            for (label, _) in labels.iter_mut().zip(names).filter(|(_, name)| !deforms(name)) {
                *label = None;
            }
        }
        let depth = depths(parents);
        // The best joint for a part: not a helper, the lowest number, then the deepest (`LHipJoint` above
        // `LeftHip`).
        let best = |parts: &[Part], side: Option<Side>| {
            parts.iter().find_map(|&part| {
                (0..names.len())
                    .filter(|&j| labels[j].as_ref().is_some_and(|l| l.part == part && l.side == side))
                    .min_by(|&a, &b| {
                        let key = |j: usize| {
                            let l = labels[j].as_ref();
                            (l.map(|l| (l.helper, l.numbers.clone())), std::cmp::Reverse(depth[j]), j)
                        };
                        key(a).cmp(&key(b))
                    })
            })
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
            put(Role::Hand(side), best(&[Part::Hand], s));
            let has_thigh = best(&[Part::Thigh], s).is_some();
            put(Role::Thigh(side), best(&[Part::Thigh, Part::Leg], s));
            put(Role::Shin(side), best(if has_thigh { &[Part::Shin, Part::Leg] } else { &[Part::Shin] }, s));
            put(Role::Foot(side), best(&[Part::Foot], s));
            put(Role::Toe(side), best(&[Part::Toe], s));
        }
        let meet =
            |a: Option<usize>, b: Option<usize>| Some(common_ancestor(parents, &depth, a?, b?)).flatten();
        let find = |joints: &BTreeMap<Role, usize>, role| joints.get(&role).copied();
        let legs = meet(find(&joints, Role::Thigh(Side::Left)), find(&joints, Role::Thigh(Side::Right)));
        let arms =
            meet(find(&joints, Role::UpperArm(Side::Left)), find(&joints, Role::UpperArm(Side::Right)));
        if let (None, Some(arms)) = (find(&joints, Role::Head), arms)
            && let Some(head) = end_of_spine(&labels, parents, arms)
        {
            joints.insert(Role::Head, head);
        }
        let head = find(&joints, Role::Head).or_else(|| best(&[Part::Neck], None));
        let hips = meet(legs, head).or_else(|| best(&[Part::Hips], None));
        let mut figure = Self { joints, ..Self::default() };
        if let Some(hips) = hips {
            figure.joints.insert(Role::Hips, hips);
        }
        if let Some(legs) = legs.filter(|&legs| Some(legs) != hips) {
            figure.joints.insert(Role::Pelvis, legs);
        }
        if let Some(arms) = arms {
            figure.joints.insert(Role::Chest, arms);
        }
        if let (Some(hips), Some(head)) = (hips, head) {
            figure.split_trunk(&labels, parents, hips, head);
        }
        figure
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
