//! Weights of a face that a user sets.

use std::collections::BTreeMap;

use lovelock_base::field;
use lovelock_base::settings::{Part, PartMut, Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

/// Weights that are added to those of the clip, by the name of an expression or a morph target. Unknown names are kept and have no effect.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FaceWeights(pub BTreeMap<String, FaceWeight>);

/// A weight of an expression or a morph target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FaceWeight {
    /// How far it is shown: 0 is not at all, 1 fully.
    pub weight: f32,
}

impl FaceWeights {
    /// The most weights that are kept.
    const MAX: usize = 4000;
    /// The longest name, characters.
    const LONGEST_NAME: usize = 200;

    /// The weight of a name; 0 where none is set.
    pub fn of(&self, name: &str) -> f32 {
        self.0.get(name).map_or(0.0, |of| of.weight)
    }

    /// Sets a weight. 0 removes it.
    pub fn set(&mut self, name: &str, weight: f32) {
        if weight == 0.0 {
            self.0.remove(name);
        } else {
            self.0.insert(name.to_owned(), FaceWeight { weight });
        }
    }
}

impl Settings for FaceWeights {
    const TABLE: &'static [Setting<Self>] = &[];

    fn parts(&self) -> Vec<Part<'_>> {
        self.0.iter().map(|(name, of)| -> Part<'_> { (name.clone().into(), of) }).collect()
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        self.0.iter_mut().map(|(name, of)| -> PartMut<'_> { (name.clone().into(), of) }).collect()
    }

    fn reconcile(&mut self) {
        let named = std::mem::take(&mut self.0).into_iter();
        let named = named.filter(|(name, _)| name.chars().count() <= Self::LONGEST_NAME);
        self.0 = named.take(Self::MAX).collect();
    }
}

impl Settings for FaceWeight {
    const TABLE: &'static [Setting<Self>] = &[Setting::number(
        field!(Self, weight),
        [-1.0, 2.0],
        "Weight",
        "How far an expression or a morph target of the body is shown, in addition to what the clip does: 0 is not at all, 1 fully.",
    )
    .soft([0.0, 1.0])
    .unit(Unit::FRACTION)];
}
