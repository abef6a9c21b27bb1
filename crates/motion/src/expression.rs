//! Expressions of a face: morph targets under one name.

use crate::Track;

/// A facial expression: weights of morph targets under one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expression {
    /// Its name: that of its preset, or one of the file's own.
    pub name: String,
    /// Its preset by the name of VRM 1.0, such as `blink` or `aa`.
    pub preset: Option<&'static str>,
    /// Whether it is fully shown or not at all, and nothing between.
    pub is_binary: bool,
    /// The morph targets that it moves, with the weights that they have when it is fully shown.
    pub morphs: Vec<(usize, f32)>,
}

impl Expression {
    /// Adds what a weight of the expression does to the weights of morph targets.
    pub(crate) fn add(&self, weight: f32, morph_weights: &mut [f32]) {
        let weight = if self.is_binary { f32::from(u8::from(weight > 0.5)) } else { weight };
        for &(morph, share) in self.morphs.iter().filter(|_| weight != 0.0) {
            if let Some(sum) = morph_weights.get_mut(morph) {
                *sum += weight * share;
            }
        }
    }
}

/// The weights that a motion gives a face by name, whatever the figure.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceTrack {
    /// Name of the expression or of the morph target.
    pub name: String,
    /// Its weight over time; times count from the first frame.
    pub track: Track<f32>,
}
