//! The joints that move a vertex: skins, their inverse bind matrices, and meshes that follow one node.

use std::collections::BTreeMap;

use glam::{Affine3A, Mat4};

use lovelock_base::words::counted;
use lovelock_gltf::Accessors;
use lovelock_gltf::document::Primitive;

use crate::MotionError;
use crate::surface::{Palette, VertexWeights, WeightSums};

/// The palette entries of the joints of one skin.
pub(super) fn read_skin(
    accessors: &Accessors,
    skin: usize,
    joint_of_node: &[Option<usize>],
    palette: &mut Palette,
    dropped: &mut BTreeMap<String, u64>,
) -> Result<Vec<u16>, MotionError> {
    let error = |problem: String| MotionError::malformed(accessors.file, format!("skin {skin}"), problem);
    let data = accessors.document.skins.get(skin).ok_or_else(|| error("does not exist".into()))?;
    let matrices = match data.inverse_bind_matrices {
        Some(accessor) => accessors.read::<16>(accessor)?,
        None => Vec::new(),
    };
    if data.inverse_bind_matrices.is_some() && matrices.len() < data.joints.len() {
        return Err(error(format!(
            "{} inverse bind matrices for {} joints",
            matrices.len(),
            data.joints.len()
        )));
    }
    let mut binds = Vec::with_capacity(data.joints.len());
    for (k, &node) in data.joints.iter().enumerate() {
        let joint =
            joint_of_node[node].ok_or_else(|| error(format!("joint node {node} is not in the scene")))?;
        let matrix = matrices.get(k).map_or(Mat4::IDENTITY, Mat4::from_cols_array);
        let joint_from_bind = if matrix.is_finite() {
            Affine3A::from_mat4(matrix)
        } else {
            *dropped.entry("bind_matrices".into()).or_default() += 1;
            Affine3A::IDENTITY
        };
        let too_many = || error(format!("more than {} different binds", u16::MAX));
        binds.push(palette.add(joint, joint_from_bind).ok_or_else(too_many)?);
    }
    Ok(binds)
}

/// Reads `JOINTS_n` and `WEIGHTS_n` of a primitive, for every `n`.
pub(super) fn read_vertex_weights(
    accessors: &Accessors,
    primitive: &Primitive,
    vertices: usize,
    skin: &[u16],
    dropped: &mut BTreeMap<String, u64>,
) -> Result<Vec<VertexWeights>, MotionError> {
    let mut sets = Vec::new();
    while let (Some(&joints), Some(&weights)) = (
        primitive.attributes.get(&format!("JOINTS_{}", sets.len())),
        primitive.attributes.get(&format!("WEIGHTS_{}", sets.len())),
    ) {
        for accessor in [joints, weights] {
            if accessors.count(accessor)? != vertices as u64 {
                let elements = counted(accessors.count(accessor)?, "element", "elements");
                let vertices = counted(vertices, "vertex", "vertices");
                let problem = format!("{elements}; the mesh has {vertices}");
                return Err(MotionError::malformed(accessors.file, format!("accessor {accessor}"), problem));
            }
        }
        sets.push((accessors.read_indices::<4>(joints)?, accessors.read::<4>(weights)?));
    }
    let mut sums = WeightSums::default();
    let otherwise = skin.first().copied().unwrap_or(0);
    let mut influences = Vec::with_capacity(vertices);
    for v in 0..vertices {
        for (joints, weights) in &sets {
            for (&joint, &weight) in joints[v].iter().zip(&weights[v]) {
                sums.add(skin.get(joint as usize).copied(), weight);
            }
        }
        influences.push(sums.take(otherwise));
    }
    sums.report(dropped);
    Ok(influences)
}
