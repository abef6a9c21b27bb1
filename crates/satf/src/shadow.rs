//! The shadow that the layers of a cluster cast on each other (Xu et al., "SATF", section 6.4).

use std::f32::consts::TAU;

use glam::Vec2;
use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

/// How a cluster shadows itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LocalShadow {
    /// By the shadow map that strands use, looked up at each layer.
    #[default]
    Map,
    /// The layers outside a point dim it as layers do that light passes through: the product of `1 − α`. The map is looked up where light
    /// enters the cluster.
    Layers,
    /// The approximation at the end of equation 12, `1 − k Σ α`, never below 0.
    Linear,
    /// The product as in [`LocalShadow::Layers`], of the layers that the light meets on its way to the point: at the angle around the
    /// cluster where it meets them, and those beyond the core for the side away from the light.
    Directional,
    /// Equation 12 as published: `e^(−k Σ α)` over the layers outside.
    Exponential,
}

impl Choices for LocalShadow {
    // A track stores the place in this list.
    const ALL: &'static [Self] =
        &[Self::Map, Self::Layers, Self::Linear, Self::Directional, Self::Exponential];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Map => ("map", "Shadow map"),
            Self::Layers => ("layers", "Outer layers, product"),
            Self::Linear => ("linear", "Outer layers, linear"),
            Self::Directional => ("directional", "Layers toward the light"),
            Self::Exponential => ("exponential", "Outer layers, as published"),
        }
    }
}

/// Transmittance through the `outside` layers, given by their opacities at the same place of the layers. Symbol: `τ_k`.
///
/// With a `strength` of 1 the product of `1 − α` is exact; symbol: `k_sh`.
pub fn transmittance(mode: LocalShadow, strength: f32, outside: impl IntoIterator<Item = f32>) -> f32 {
    let outside = outside.into_iter();
    match mode {
        LocalShadow::Linear => (1.0 - strength * outside.sum::<f32>()).max(0.0),
        LocalShadow::Exponential => (-strength * outside.sum::<f32>()).exp(),
        LocalShadow::Map | LocalShadow::Layers | LocalShadow::Directional => {
            let depth: f32 = outside.map(optical_depth).sum();
            (-strength * depth).exp()
        }
    }
}

/// The optical depth of a layer of opacity `opacity`. An opaque one has that of 1 part in 10⁶.
pub fn optical_depth(opacity: f32) -> f32 {
    -(1.0 - opacity.clamp(0.0, 1.0)).max(1e-6).ln()
}

/// Where light meets a layer on its way to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The layer, 0 innermost.
    pub layer: usize,
    /// Angle around the disk, radians, 0..2π.
    pub u: f32,
    /// Direction of the light at the layer, as the cosine with the outward normal: negative where light leaves the inside.
    pub facing: f32,
}

/// Calls `meet` for every layer that light crosses on its way to a point of `layer` at the angle `u`.
///
/// `to_light` is the direction toward the light within the disk, where the layers are circles of the radii `radii`, rising
/// from the innermost. The layer of the point itself shadows it only where the light comes through the core.
pub fn crossings(radii: &[f32], layer: usize, u: f32, to_light: Vec2, mut meet: impl FnMut(Crossing)) {
    let Some(&radius) = radii.get(layer) else { return };
    let Some(direction) = to_light.try_normalize() else { return };
    let start = radius * Vec2::from_angle(u);
    let along = start.dot(direction);
    // The distance of the ray from the axis, squared.
    let nearest = radius * radius - along * along;
    let mut cross = |layer: usize, radius: f32, side: f32| {
        let half = (radius * radius - nearest).max(0.0).sqrt();
        let at = start + direction * (side * half - along);
        if let Some(normal) = at.try_normalize() {
            let u = at.to_angle().rem_euclid(TAU);
            meet(Crossing { layer, u, facing: normal.dot(direction) });
        }
    };
    for (m, &outer) in radii.iter().enumerate() {
        if m > layer {
            cross(m, outer, 1.0);
        } else if along < 0.0 && outer * outer > nearest {
            // Through the inside: layers within are met twice, that of the point once more.
            if m < layer {
                cross(m, outer, -1.0);
            }
            cross(m, outer, 1.0);
        }
    }
}
