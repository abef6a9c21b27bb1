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

impl VertexWeights {
    /// A vertex that follows one palette entry.
    pub(crate) fn rigid(bind: u16) -> Self {
        let mut weights = [0.0; 8];
        weights[0] = 1.0;
        Self { binds: [bind; 8], weights }
    }
}

/// Collects the weights of vertices, one vertex after the other, and counts what is left out.
#[derive(Debug, Default)]
pub(crate) struct WeightSums {
    /// Weight of each palette entry for the vertex at hand.
    found: Vec<(u16, f32)>,
    unknown_joints: u64,
    beyond: u64,
    unweighted: u64,
}

impl WeightSums {
    /// Adds a weight of the vertex at hand. `bind` is `None` if its joint does not exist; weights that are not positive count for nothing.
    pub(crate) fn add(&mut self, bind: Option<u16>, weight: f32) {
        if !(weight > 0.0 && weight.is_finite()) {
            return;
        }
        match bind {
            Some(bind) => match self.found.iter_mut().find(|(known, _)| *known == bind) {
                Some((_, sum)) => *sum += weight,
                None => self.found.push((bind, weight)),
            },
            None => self.unknown_joints += 1,
        }
    }

    /// The eight heaviest weights of the vertex at hand; one without any follows `otherwise`. The next vertex begins.
    pub(crate) fn take(&mut self, otherwise: u16) -> VertexWeights {
        let found = &mut self.found;
        found.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        self.beyond += found.len().saturating_sub(8) as u64;
        found.truncate(8);
        let sum: f32 = found.iter().map(|(_, w)| w).sum();
        let weights = if sum < 1e-6 || !sum.is_finite() {
            self.unweighted += 1;
            VertexWeights::rigid(otherwise)
        } else {
            let mut of = VertexWeights { binds: [found[0].0; 8], weights: [0.0; 8] };
            for (k, &(bind, weight)) in found.iter().enumerate() {
                of.binds[k] = bind;
                of.weights[k] = weight / sum;
            }
            of
        };
        found.clear();
        weights
    }

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
