//! Grouping of the surface by body part.

use glam::Vec3;

use crate::{
    Body,
    head::{head_mesh, neck_joints},
    humanoid::{Humanoid, Role, Side},
};

/// The kind of a part, which determines its shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Head,
    Neck,
    /// Wide and flat: horizontal capsules.
    Trunk,
    /// All of a figure without joints but its head: horizontal capsules below the head.
    Whole,
    /// Round and long: a capsule from this joint toward the next.
    Limb,
    /// Out of reach of hair.
    Ignored,
}

/// A body part with its resting vertices, world space.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) joint: usize,
    /// End of the bone, if known.
    pub(super) end: Option<Vec3>,
    /// Start of the bone, if that is not the joint: a shoulder starts at the neck.
    pub(super) begin: Option<Vec3>,
    pub(super) points: Vec<Vec3>,
    /// Scalp mask of each point; 0 except on the head.
    pub(super) scalp: Vec<f32>,
}

/// Smallest number of vertices for a shape.
const FEWEST: usize = 12;

/// Groups the surface into parts. If the joint names are unknown, every joint becomes a limb, besides the
/// head.
pub(super) fn parts(body: &Body) -> Vec<Part> {
    let skeleton = &body.skeleton;
    if skeleton.joints.is_empty() {
        return Vec::new();
    }
    let figure = Humanoid::of_skeleton(skeleton);
    let mut parts = vec![part("head", Kind::Head, body.head_joint, None)];
    let mut part_of_joint: Vec<Option<usize>> = vec![None; skeleton.joints.len()];
    let at = |role: Role| figure.get(role).map(|j| skeleton.rest_position(j));
    let mut claim = |parts: &mut Vec<Part>, joint: usize, new: Part| {
        if part_of_joint[joint].is_none() && joint != body.head_joint {
            part_of_joint[joint] = Some(parts.len());
            parts.push(new);
        }
    };
    let neck = neck_joints(body);
    if let Some(&first) = neck.first() {
        let end = Some(skeleton.rest_position(body.head_joint));
        claim(&mut parts, first, part("neck", Kind::Neck, first, end));
    }
    let known = figure.get(Role::Hips).is_some() && figure.get(Role::Chest).is_some();
    if known {
        for (i, &j) in figure.get(Role::Hips).iter().chain(&figure.spine).enumerate() {
            claim(&mut parts, j, part(&format!("trunk {}", i + 1), Kind::Trunk, j, None));
        }
        for (side, word) in [(Side::Left, "left"), (Side::Right, "right")] {
            let chain = [
                (Role::Clavicle(side), Role::UpperArm(side), "shoulder"),
                (Role::UpperArm(side), Role::Forearm(side), "upper arm"),
                (Role::Forearm(side), Role::Hand(side), "forearm"),
                (Role::Hand(side), Role::Hand(side), "hand"),
                (Role::Thigh(side), Role::Shin(side), "thigh"),
                (Role::Shin(side), Role::Foot(side), "shin"),
                (Role::Foot(side), Role::Foot(side), "foot"),
            ];
            for (role, next, name) in chain {
                if let Some(j) = figure.get(role) {
                    let end = if role == next { None } else { at(next) };
                    let kind = if matches!(role, Role::Shin(_) | Role::Foot(_)) {
                        Kind::Ignored
                    } else {
                        Kind::Limb
                    };
                    let mut new = part(&format!("{name} {word}"), kind, j, end);
                    if let Role::Clavicle(_) = role {
                        new.begin = neck.first().map(|&n| skeleton.rest_position(n)).or(at(Role::Head));
                    }
                    claim(&mut parts, j, new);
                }
            }
        }
    } else {
        for j in 0..skeleton.joints.len() {
            if !skeleton.is_below(j, body.head_joint) {
                let child = skeleton.joints.iter().position(|c| c.parent == Some(j));
                let end = child.map(|c| skeleton.rest_position(c));
                claim(&mut parts, j, part(&skeleton.joints[j].name.clone(), Kind::Limb, j, end));
            }
        }
    }
    part_of_joint[body.head_joint] = Some(0);
    // A joint without a part of its own belongs to the nearest ancestor that has one.
    for j in 0..skeleton.joints.len() {
        part_of_joint[j] = part_of_joint[j].or(skeleton.joints[j].parent.and_then(|p| part_of_joint[p]));
    }
    let mut scalp = vec![0.0; body.mesh.positions.len()];
    let head = head_mesh(body);
    for (&v, &mask) in head.vertex.iter().zip(&head.scalp) {
        scalp[v as usize] = mask;
    }
    for (v, &p) in body.mesh.positions.iter().enumerate() {
        if let Some(k) = part_of_joint[body.dominant_joint(v)] {
            parts[k].points.push(p);
            parts[k].scalp.push(scalp[v]);
        }
    }
    parts.retain(|p| p.points.len() >= FEWEST && p.kind != Kind::Ignored);
    if let [head, below] = &mut parts[..]
        && (head.kind, below.kind) == (Kind::Head, Kind::Limb)
        && skeleton.joints.get(head.joint).is_some_and(|joint| joint.parent == Some(below.joint))
    {
        (below.kind, below.end) = (Kind::Whole, Some(skeleton.rest_position(head.joint)));
    }
    parts
}

fn part(name: &str, kind: Kind, joint: usize, end: Option<Vec3>) -> Part {
    Part { name: name.to_owned(), kind, joint, end, begin: None, points: Vec::new(), scalp: Vec::new() }
}

impl Part {
    /// Whether a position is inside the bounding box of the part.
    pub(super) fn contains(&self, p: Vec3) -> bool {
        let low = self.points.iter().fold(Vec3::INFINITY, |a, &b| a.min(b));
        let high = self.points.iter().fold(Vec3::NEG_INFINITY, |a, &b| a.max(b));
        p.cmpge(low).all() && p.cmple(high).all()
    }
}
