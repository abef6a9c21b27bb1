//! The joint that carries the hair: a guess, and paths for the user to choose from.

use crate::{
    Mesh, Skeleton,
    humanoid::{Role, role_of},
};

/// Guesses the joint that carries the head.
///
/// It is the joint that the file says it is, otherwise the joint named head that moves some of the surface, and of several the one that moves most. If no
/// name helps, it is the joint that moves the topmost part of the rest pose.
pub fn guess_head(skeleton: &Skeleton, mesh: &Mesh) -> usize {
    let count = skeleton.joints.len();
    if count == 0 {
        return 0;
    }
    if let Some((&head, _)) = skeleton.named.iter().find(|(_, bone)| *bone == "head") {
        return head;
    }
    let mut weight = vec![0.0_f64; count];
    for (joints, weights) in mesh.joints.iter().zip(&mesh.weights) {
        for (&j, &w) in joints.iter().zip(weights) {
            if let Some(sum) = weight.get_mut(usize::from(j)) {
                *sum += f64::from(w);
            }
        }
    }
    // A head without weights of its own may carry facial bones.
    let mut carried = weight.clone();
    for j in (0..count).rev() {
        if let Some(p) = skeleton.joints[j].parent {
            carried[p] += carried[j];
        }
    }
    let heads =
        (0..count).filter(|&j| role_of(&skeleton.joints[j].name) == Some(Role::Head) && carried[j] > 0.0);
    if let Some(head) = heads.max_by(|&a, &b| carried[a].total_cmp(&carried[b]).then(b.cmp(&a))) {
        return head;
    }
    topmost(skeleton, mesh, &weight)
}

/// The joint that moves most of the top tenth of the surface; if there is none, the topmost joint.
fn topmost(skeleton: &Skeleton, mesh: &Mesh, weight: &[f64]) -> usize {
    let count = skeleton.joints.len();
    let (low, high) =
        mesh.positions.iter().fold((f32::MAX, f32::MIN), |(low, high), p| (low.min(p.y), high.max(p.y)));
    let line = high - 0.1 * (high - low);
    let mut top = vec![0.0_f64; count];
    for (v, p) in mesh.positions.iter().enumerate().filter(|(_, p)| p.y >= line) {
        for (&j, &w) in mesh.joints[v].iter().zip(&mesh.weights[v]) {
            if let Some(sum) = top.get_mut(usize::from(j)) {
                // Higher vertices weigh more, so that raised hands do not outweigh the crown.
                *sum += f64::from(w * (p.y - line));
            }
        }
    }
    let best = (0..count).max_by(|&a, &b| top[a].total_cmp(&top[b]).then(b.cmp(&a)));
    best.filter(|&j| top[j] > 0.0).unwrap_or_else(|| {
        (0..count)
            .filter(|&j| weight[j] > 0.0)
            .max_by(|&a, &b| skeleton.rest_position(a).y.total_cmp(&skeleton.rest_position(b).y))
            .unwrap_or(0)
    })
}

/// A path for each joint, such as `hips/spine/neck/head`, which distinguishes joints of the same name. Joints
/// with equal paths also get their number.
pub fn joint_paths(skeleton: &Skeleton) -> Vec<String> {
    let mut paths: Vec<String> = Vec::with_capacity(skeleton.joints.len());
    let mut seen = std::collections::BTreeSet::new();
    for (j, joint) in skeleton.joints.iter().enumerate() {
        let mut path = match joint.parent {
            // Deep chains keep their end, to stay readable.
            Some(p) if paths[p].len() < 400 => format!("{}/{}", paths[p], joint.name),
            Some(p) => format!("…/{}/{}", skeleton.joints[p].name, joint.name),
            None => joint.name.clone(),
        };
        if !seen.insert(path.clone()) {
            path = format!("{path} ({j})");
            seen.insert(path.clone());
        }
        paths.push(path);
    }
    paths
}
