//! The joints that move a vertex: skins, their inverse bind matrices, and meshes that follow one node.

use std::collections::{BTreeMap, HashMap};

use glam::{Affine3A, Mat4};

use super::{accessor::Accessors, document::Primitive};
use crate::{Bind, MotionError};

/// The joints of all skins with their bind transforms, without duplicates.
#[derive(Default)]
pub(super) struct Palette {
    pub(super) binds: Vec<Bind>,
    index: HashMap<(u16, [u32; 12]), u16>,
}

impl Palette {
    /// Index of a pair, which is added if it is new; `None` if there are too many.
    pub(super) fn add(&mut self, joint: usize, joint_from_bind: Affine3A) -> Option<u16> {
        let joint = u16::try_from(joint).ok()?;
        let key = (joint, joint_from_bind.to_cols_array().map(f32::to_bits));
        if let Some(&known) = self.index.get(&key) {
            return Some(known);
        }
        let new = u16::try_from(self.binds.len()).ok()?;
        self.binds.push(Bind { joint, joint_from_bind });
        self.index.insert(key, new);
        Some(new)
    }
}

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

/// Up to eight joints of a vertex with weights that sum to 1, heaviest first.
#[derive(Clone, Copy)]
pub(super) struct VertexWeights {
    pub(super) binds: [u16; 8],
    pub(super) weights: [f32; 8],
}

impl VertexWeights {
    pub(super) fn rigid(bind: u16) -> Self {
        let mut weights = [0.0; 8];
        weights[0] = 1.0;
        Self { binds: [bind; 8], weights }
    }
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
                let problem =
                    format!("{} elements; the mesh has {vertices} vertices", accessors.count(accessor)?);
                return Err(MotionError::malformed(accessors.file, format!("accessor {accessor}"), problem));
            }
        }
        sets.push((accessors.read_indices::<4>(joints)?, accessors.read::<4>(weights)?));
    }
    let (mut unknown_joints, mut beyond, mut unweighted) = (0, 0, 0);
    let mut found: Vec<(u16, f32)> = Vec::new();
    let mut influences = Vec::with_capacity(vertices);
    for v in 0..vertices {
        found.clear();
        for (joints, weights) in &sets {
            for (&joint, &weight) in joints[v].iter().zip(&weights[v]) {
                if !(weight > 0.0 && weight.is_finite()) {
                    continue;
                }
                match skin.get(joint as usize) {
                    Some(&bind) => match found.iter_mut().find(|(b, _)| *b == bind) {
                        Some((_, sum)) => *sum += weight,
                        None => found.push((bind, weight)),
                    },
                    None => unknown_joints += 1,
                }
            }
        }
        found.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        beyond += found.len().saturating_sub(8) as u64;
        found.truncate(8);
        let sum: f32 = found.iter().map(|(_, w)| w).sum();
        if sum < 1e-6 || !sum.is_finite() {
            unweighted += 1;
            influences.push(VertexWeights::rigid(skin.first().copied().unwrap_or(0)));
            continue;
        }
        let mut influence = VertexWeights { binds: [found[0].0; 8], weights: [0.0; 8] };
        for (k, &(bind, weight)) in found.iter().enumerate() {
            influence.binds[k] = bind;
            influence.weights[k] = weight / sum;
        }
        influences.push(influence);
    }
    for (what, count) in [
        ("weights_of_unknown_joints", unknown_joints),
        ("weights_beyond_eight", beyond),
        ("vertices_without_weights", unweighted),
    ] {
        if count > 0 {
            *dropped.entry(what.into()).or_default() += count;
        }
    }
    Ok(influences)
}
