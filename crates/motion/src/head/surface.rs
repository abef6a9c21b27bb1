//! The part of the surface that is head and neck.

use glam::Vec3;

use super::scalp::guess_scalp;
use crate::{Body, humanoid::Humanoid};

/// Head and neck at rest in head space (see [`crate::Pose::world_from_head`]), for hair to grow on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeadMesh {
    /// Vertices, metres.
    pub positions: Vec<Vec3>,
    /// Outward unit normals.
    pub normals: Vec<Vec3>,
    /// Counter-clockwise triangles.
    pub triangles: Vec<[u32; 3]>,
    /// 1 where hair grows, fading to 0 at the hairline.
    pub scalp: Vec<f32>,
    /// Index of each vertex in the body's mesh.
    pub vertex: Vec<u32>,
    /// Whether the file had no mask, so that the hairline is a guess.
    pub scalp_is_guessed: bool,
}

/// Extracts head and neck from the resting body: the vertices moved mostly by the head joint, its descendants
/// and the neck joints. If the head joint moves hardly anything, the whole surface is returned.
pub fn head_mesh(body: &Body) -> HeadMesh {
    let mesh = &body.mesh;
    let head = body.head_joint;
    let count = mesh.positions.len();
    if body.skeleton.joints.is_empty() || count == 0 {
        return HeadMesh::default();
    }
    let is_head: Vec<bool> =
        (0..body.skeleton.joints.len()).map(|j| body.skeleton.is_below(j, head)).collect();
    let mut is_part = is_head.clone();
    for j in neck_joints(body) {
        is_part[j] = true;
    }
    let share = |v: usize, part: &[bool]| -> f32 {
        mesh.joints[v]
            .iter()
            .zip(&mesh.weights[v])
            .filter(|(j, _)| part[usize::from(**j)])
            .map(|(_, w)| w)
            .sum()
    };
    let mut chosen: Vec<bool> = (0..count).map(|v| share(v, &is_part) >= 0.5).collect();
    if chosen.iter().filter(|c| **c).count() < 32 {
        chosen.fill(true);
    }
    let origin = body.skeleton.rest_position(head);
    let mut out = HeadMesh::default();
    let mut slot = vec![u32::MAX; count];
    let mut of_head = Vec::new();
    for v in (0..count).filter(|&v| chosen[v]) {
        slot[v] = out.positions.len() as u32;
        out.positions.push(mesh.positions[v] - origin);
        out.normals.push(mesh.normals[v]);
        out.vertex.push(v as u32);
        of_head.push(share(v, &is_head) >= 0.5);
    }
    out.triangles = mesh
        .triangles
        .iter()
        .map(|t| t.map(|v| slot[v as usize]))
        .filter(|t| !t.contains(&u32::MAX))
        .collect();
    out.scalp_is_guessed = mesh.scalp.is_empty();
    out.scalp = if out.scalp_is_guessed {
        guess_scalp(&out.positions, &out.normals, &of_head)
    } else {
        out.vertex.iter().map(|&v| mesh.scalp[v as usize]).collect()
    };
    out
}

/// The whole resting surface in head space, for hair that grows on all of the skin: where the file has a mask, on what it marks, and
/// else everywhere.
pub(crate) fn skin_mesh(body: &Body) -> HeadMesh {
    let mesh = &body.mesh;
    if body.skeleton.joints.is_empty() {
        return HeadMesh::default();
    }
    let origin = body.skeleton.rest_position(body.head_joint);
    HeadMesh {
        positions: mesh.positions.iter().map(|p| *p - origin).collect(),
        normals: mesh.normals.clone(),
        triangles: mesh.triangles.clone(),
        scalp: if mesh.scalp.is_empty() { vec![1.0; mesh.positions.len()] } else { mesh.scalp.clone() },
        vertex: (0..mesh.positions.len() as u32).collect(),
        scalp_is_guessed: false,
    }
}

/// Joints between the chest and the head.
pub(crate) fn neck_joints(body: &Body) -> Vec<usize> {
    let figure = Humanoid::of_skeleton(&body.skeleton);
    figure
        .neck
        .into_iter()
        .filter(|&j| j != body.head_joint && body.skeleton.is_below(body.head_joint, j))
        .collect()
}
