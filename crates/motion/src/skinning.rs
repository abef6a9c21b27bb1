//! The surface at one instant: morph targets, then linear blend skinning.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use rayon::prelude::*;

use crate::{Body, Pose, pose_at};

/// The surface of a body at one instant, in world space; triangles and colours are those of the mesh. It is
/// reused from frame to frame without allocation.
#[derive(Clone, Debug, Default)]
pub struct Skin {
    /// Positions, metres, one per vertex of the mesh.
    pub positions: Vec<Vec3>,
    /// Outward unit normals.
    pub normals: Vec<Vec3>,
    palette: Vec<(Affine3A, Mat3A)>,
    morphed: Vec<(Vec3, Vec3)>,
}

/// Vertices per task.
const CHUNK: usize = 1024;

/// Deforms the surface into a pose.
///
/// Linear blend skinning: `p = sum_k w_k * world_from_joint_k * joint_from_bind_k * p_bind` (glTF 2.0,
/// section 3.7.3). Normals are transformed by the cofactor of the blended map, so they stay correct under
/// non-uniform scale. The result does not depend on the number of threads.
pub fn skin(body: &Body, pose: &Pose, out: &mut Skin) {
    let data = &body.skin;
    out.palette.clear();
    out.palette.extend(data.palette.iter().map(|bind| {
        let world = pose.world_from_joint.get(usize::from(bind.joint)).copied().unwrap_or(Affine3A::IDENTITY);
        let map = world * bind.joint_from_bind;
        (map, normal_map(&map.matrix3))
    }));
    let morphing = data.morphs.iter().zip(&pose.morph_weights).any(|(_, &w)| w != 0.0);
    out.morphed.clear();
    if morphing {
        out.morphed.extend(data.positions.iter().copied().zip(data.normals.iter().copied()));
        for (morph, &weight) in data.morphs.iter().zip(&pose.morph_weights).filter(|(_, w)| **w != 0.0) {
            for ((&v, &dp), &dn) in morph.vertices.iter().zip(&morph.positions).zip(&morph.normals) {
                let (p, n) = &mut out.morphed[v as usize];
                *p += weight * dp;
                *n += weight * dn;
            }
        }
    }
    let count = data.positions.len();
    out.positions.resize(count, Vec3::ZERO);
    out.normals.resize(count, Vec3::ZERO);
    let (palette, morphed) = (&out.palette, &out.morphed);
    out.positions.par_chunks_mut(CHUNK).zip(out.normals.par_chunks_mut(CHUNK)).enumerate().for_each(
        |(chunk, (positions, normals))| {
            for (i, (position, normal)) in positions.iter_mut().zip(normals).enumerate() {
                let v = chunk * CHUNK + i;
                let (p, n) = if morphing { morphed[v] } else { (data.positions[v], data.normals[v]) };
                (*position, *normal) = skin_vertex(palette, &data.binds[v], &body.mesh.weights[v], p, n);
            }
        },
    );
}

/// Skins the surface in the rest pose and writes the result to the mesh.
pub(crate) fn update_rest_surface(body: &mut Body) {
    let (mut pose, mut rest) = (Pose::default(), Skin::default());
    pose_at(body, None, 0.0, &mut pose);
    skin(body, &pose, &mut rest);
    body.mesh.positions = rest.positions;
    body.mesh.normals = rest.normals;
}

fn skin_vertex(
    palette: &[(Affine3A, Mat3A)],
    binds: &[u16; 8],
    weights: &[f32; 8],
    position: Vec3,
    normal: Vec3,
) -> (Vec3, Vec3) {
    let (p, n) = (Vec3A::from(position), Vec3A::from(normal));
    let (mut at, mut facing) = (Vec3A::ZERO, Vec3A::ZERO);
    for (&bind, &weight) in binds.iter().zip(weights) {
        // Weights are sorted, heaviest first, so the remaining ones are zero.
        if weight == 0.0 {
            break;
        }
        let (map, normal_map) = &palette[usize::from(bind)];
        at += weight * map.transform_point3a(p);
        facing += weight * (*normal_map * n);
    }
    (at.into(), Vec3::from(facing).normalize_or(normal))
}

/// Inverse transpose of a linear map up to a positive factor, so that maps of different scale blend evenly
/// and a singular map still gives a finite result.
fn normal_map(linear: &Mat3A) -> Mat3A {
    let (a, b, c) = (linear.x_axis, linear.y_axis, linear.z_axis);
    let cofactor = Mat3A::from_cols(b.cross(c), c.cross(a), a.cross(b));
    let determinant = a.dot(b.cross(c));
    let size = determinant.abs().cbrt();
    let scale = if size > 1e-20 { determinant.signum() / (size * size) } else { 1.0 };
    cofactor * scale
}
