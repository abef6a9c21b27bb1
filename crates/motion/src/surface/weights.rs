//! The joints that move vertices, with their bind transforms.

use std::collections::{BTreeMap, HashMap};

use glam::Affine3A;

use crate::Bind;

/// The joints of all skins with their bind transforms, without duplicates.
#[derive(Default)]
pub(crate) struct Palette {
    binds: Vec<Bind>,
    index: HashMap<(u16, [u32; 12]), u16>,
}

impl Palette {
    /// Index of a pair, which is added if it is new; `None` if there are too many.
    pub(crate) fn add(&mut self, joint: usize, joint_from_bind: Affine3A) -> Option<u16> {
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

    pub(super) fn into_binds(self) -> Vec<Bind> {
        self.binds
    }
}

/// Up to eight palette entries that move a vertex, with weights that sum to 1, heaviest first.
#[derive(Clone, Copy)]
pub(crate) struct VertexWeights {
    pub(crate) binds: [u16; 8],
    pub(crate) weights: [f32; 8],
}

/// What was left out of the weights of vertices.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WeightCounts {
    /// Weights of joints that do not exist.
    pub(crate) unknown_joints: u64,
    beyond: u64,
    unweighted: u64,
}

impl WeightCounts {
    /// Adds the counts to those of a file.
    pub(crate) fn report(self, dropped: &mut BTreeMap<String, u64>) {
        for (what, count) in [
            ("weights_of_unknown_joints", self.unknown_joints),
            ("weights_beyond_eight", self.beyond),
            ("vertices_without_weights", self.unweighted),
        ] {
            if count > 0 {
                *dropped.entry(what.into()).or_default() += count;
            }
        }
    }
}

impl VertexWeights {
    /// A vertex that follows one palette entry.
    pub(crate) fn rigid(bind: u16) -> Self {
        let mut weights = [0.0; 8];
        weights[0] = 1.0;
        Self { binds: [bind; 8], weights }
    }

    /// The eight heaviest of some weights, which are sorted in place; a vertex without any follows `otherwise`.
    pub(crate) fn of(found: &mut Vec<(u16, f32)>, otherwise: u16, counts: &mut WeightCounts) -> Self {
        found.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        counts.beyond += found.len().saturating_sub(8) as u64;
        found.truncate(8);
        let sum: f32 = found.iter().map(|(_, w)| w).sum();
        if sum < 1e-6 || !sum.is_finite() {
            counts.unweighted += 1;
            return Self::rigid(otherwise);
        }
        let mut of = Self { binds: [found[0].0; 8], weights: [0.0; 8] };
        for (k, &(bind, weight)) in found.iter().enumerate() {
            of.binds[k] = bind;
            of.weights[k] = weight / sum;
        }
        of
    }
}
