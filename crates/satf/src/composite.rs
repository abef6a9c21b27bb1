//! Blending of the layers (Xu et al., "SATF", section 6.5, equation 14): the definition for other implementations.

use glam::Vec3;

/// A layer at one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerSample {
    /// Light that its hair sends to the eye, linear, not multiplied by the opacity. Symbol: `Ψ_k`.
    pub color: Vec3,
    /// Opacity, 0..=1. Symbol: `α_k`.
    pub opacity: f32,
}

/// The colour of a pixel: `background · Π(1 − α_k) + Σ Ψ_k α_k Π_{j>k}(1 − α_j)`, with `layers` from the farthest to the
/// nearest.
///
/// The paper goes from the innermost to the outermost layer, which is that order only on the side of the eye. A ray through
/// the cluster meets the faces on the far side first, from the outermost to the innermost, then the core, then the near ones.
pub fn composite(background: Vec3, layers: impl IntoIterator<Item = LayerSample>) -> Vec3 {
    layers.into_iter().fold(background, |behind, layer| {
        let opacity = layer.opacity.clamp(0.0, 1.0);
        behind * (1.0 - opacity) + layer.color * opacity
    })
}
