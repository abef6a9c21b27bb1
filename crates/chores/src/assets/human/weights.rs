//! Weights of the vertices of the base mesh on the joints of our skeleton.

use anyhow::Context;
use glam::Vec3;

use super::source::Source;
use super::surface::{JOINTS, Surface, Vertex};
use crate::assets::rig::{self, Rig};

/// The joint that a bone of the rig of the package moves, and the twist joint that shares it with the direction in which its share grows.
fn joint_of(bone: &str) -> Option<(usize, Option<(usize, bool)>)> {
    let middle = match bone {
        "Root" | "pelvis" => Some(rig::HIPS),
        "spine_01" => Some(rig::SPINE),
        "spine_02" => Some(rig::SPINE_1),
        "spine_03" => Some(rig::CHEST),
        "neck_01" => Some(rig::NECK),
        "head" => Some(rig::HEAD),
        _ => None,
    };
    if let Some(joint) = middle {
        return Some((joint, None));
    }
    let (part, side) = bone.rsplit_once('_')?;
    let right = usize::from(side == "r");
    let (arm, leg) = (rig::CLAVICLE + right * rig::ARM_JOINTS, rig::THIGH + right * rig::LEG_JOINTS);
    Some(match part {
        "clavicle" => (arm, None),
        "upperarm" => (arm + rig::UPPER_ARM, Some((arm + rig::UPPER_ARM_TWIST, false))),
        "lowerarm" => (arm + rig::FOREARM, Some((arm + rig::FOREARM_TWIST, true))),
        "thigh" => (leg, Some((leg + rig::THIGH_TWIST, false))),
        "calf" => (leg + rig::SHIN, None),
        "foot" => (leg + rig::FOOT, None),
        "ball" => (leg + rig::TOES, None),
        // Hand and fingers.
        _ => (arm + rig::HAND, None),
    })
}

/// Weights of every vertex; they sum to 1 where the package has any.
pub(super) fn rows(source: &Source, rig: &Rig, positions: &[Vec3]) -> anyhow::Result<Vec<[f32; JOINTS]>> {
    let mut rows = vec![[0.0; JOINTS]; positions.len()];
    for (bone, list) in source.weights()? {
        let (joint, twist) = joint_of(&bone).with_context(|| format!("an unknown bone {bone}"))?;
        // The bone goes on to the joint's child that is not a twist joint.
        let start = rig.joints[joint].rest;
        let end = twist.and_then(|(twist, _)| rig.joints.get(twist + 1)).map_or(start, |j| j.rest);
        let axis = end - start;
        for (vertex, weight) in list {
            let Some(row) = rows.get_mut(vertex as usize) else { continue };
            let Some((twist, grows)) = twist else {
                row[joint] += weight;
                continue;
            };
            let along = (positions[vertex as usize] - start).dot(axis) / axis.length_squared().max(1e-9);
            let share = if grows {
                ((along - 0.05) / 0.85).clamp(0.0, 1.0)
            } else {
                (1.0 - along / 0.85).clamp(0.0, 1.0)
            };
            row[joint] += weight * (1.0 - share);
            row[twist] += weight * share;
        }
    }
    for row in &mut rows {
        let sum: f32 = row.iter().sum();
        if sum > 0.0 {
            for weight in row.iter_mut() {
                *weight /= sum;
            }
        }
    }
    Ok(rows)
}

/// The four largest weights in 65535ths, largest first.
pub(super) fn strongest(row: &[f32; JOINTS]) -> [(u8, u16); 4] {
    let mut order: Vec<usize> = (0..JOINTS).collect();
    order.sort_by(|a, b| row[*b].total_cmp(&row[*a]).then(a.cmp(b)));
    // The weight of the fifth joint is subtracted from all, so that a joint fades in without a jump.
    let floor = row[order[4]];
    let kept: [f32; 4] = std::array::from_fn(|i| (row[order[i]] - floor).max(0.0));
    let total: f32 = kept.iter().sum::<f32>().max(1e-9);
    let mut out: [(u8, u16); 4] =
        std::array::from_fn(|i| (order[i] as u8, (kept[i] / total * 65535.0).round() as u16));
    let others: i32 = out[1..].iter().map(|(_, w)| i32::from(*w)).sum();
    out[0].1 = (65535 - others).clamp(0, 65535) as u16;
    for entry in &mut out {
        if entry.1 == 0 {
            entry.0 = 0;
        }
    }
    out
}

/// How often weights are averaged over neighbours where edges of garments lie.
const SOFTENED: usize = 8;

/// Averages the weights of vertices at which `at` holds over their neighbours. Those of the base mesh change in steps from edge to edge, and
/// the edge of a garment, which is straight at rest, would show them as notches where an arm is raised.
pub(super) fn soften(skin: &mut Surface, at: impl Fn(&Vertex) -> bool) {
    let neighbours = skin.neighbours();
    let chosen: Vec<usize> =
        (0..skin.vertices.len()).filter(|&v| at(&skin.vertices[v]) && !neighbours[v].is_empty()).collect();
    for _ in 0..SOFTENED {
        let mean = |v: usize| -> [f32; JOINTS] {
            let ring = &neighbours[v];
            std::array::from_fn(|j| {
                let sum: f32 = ring.iter().map(|u| skin.vertices[*u as usize].weights[j]).sum();
                0.5 * (skin.vertices[v].weights[j] + sum / ring.len() as f32)
            })
        };
        let means: Vec<_> = chosen.iter().map(|v| mean(*v)).collect();
        for (v, mean) in chosen.iter().zip(means) {
            skin.vertices[*v].weights = mean;
        }
    }
}
