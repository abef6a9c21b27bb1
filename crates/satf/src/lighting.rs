//! Light on a layer of a cluster (Xu et al., "SATF", section 6.3, equations 8 to 11).

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// How strongly hair reflects, and where its highlights are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ClusterLighting {
    /// Strength of the matt part. Symbol: `k_dif`.
    pub diffuse: f32,
    /// Strength of the primary highlight, in the light's colour. Symbol: `k_speI`.
    pub primary: f32,
    /// Strength of the secondary highlight, in the hair's colour. Symbol: `k_speII`.
    pub secondary: f32,
    /// Shift of the primary highlight toward the tip: the part of the surface's normal that is added to the tangent.
    /// Symbol: `s`.
    pub primary_shift: f32,
    /// Shift of the secondary highlight toward the root: the part that is subtracted. Symbol: `s`.
    pub secondary_shift: f32,
    /// Exponent of the primary highlight; the paper has one for both. Symbol: `k_h`.
    pub primary_exponent: f32,
    /// Exponent of the secondary highlight.
    pub secondary_exponent: f32,
}

impl Default for ClusterLighting {
    fn default() -> Self {
        Self {
            diffuse: 0.35,
            primary: 0.25,
            secondary: 0.35,
            primary_shift: 0.1,
            secondary_shift: 0.15,
            primary_exponent: 80.0,
            secondary_exponent: 20.0,
        }
    }
}

/// The matt part and the two highlights at a point of a layer, in multiples of the light's irradiance, before colours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LitParts {
    /// The matt part, of the hair's colour.
    pub diffuse: f32,
    /// The primary highlight, of the light's colour.
    pub primary: f32,
    /// The secondary highlight, of the hair's colour.
    pub secondary: f32,
}

impl LitParts {
    /// The colour of the light that leaves the point (equation 8), for hair of the colour `hair` under `light`; linear.
    pub fn color(&self, hair: Vec3, light: Vec3) -> Vec3 {
        light * (hair * (self.diffuse + self.secondary) + self.primary)
    }
}

impl ClusterLighting {
    /// The parts at a point whose hair runs along `tangent`, from root to tip, on a surface with the outward `normal`;
    /// `to_light` and `to_eye` lead away from it. All are unit vectors.
    pub fn parts(&self, tangent: Vec3, normal: Vec3, to_light: Vec3, to_eye: Vec3) -> LitParts {
        let shifted = |shift: f32| (tangent + shift * normal).normalize_or(tangent);
        LitParts {
            diffuse: self.diffuse * sine(tangent.dot(to_light)),
            primary: self.primary
                * highlight(shifted(self.primary_shift), to_light, to_eye, self.primary_exponent),
            secondary: self.secondary
                * highlight(shifted(-self.secondary_shift), to_light, to_eye, self.secondary_exponent),
        }
    }
}

/// The highlight of a strand along `tangent`: 1 on the cone of mirrored directions, `tangent · to_eye = −tangent · to_light`.
///
/// Printed is `(t·l)(t·v) + sin sin`. With both directions away from the strand that is 1 where `t·v = t·l`, on the cone of
/// the light itself; the sign is turned here.
fn highlight(tangent: Vec3, to_light: Vec3, to_eye: Vec3, exponent: f32) -> f32 {
    let (light, eye) = (tangent.dot(to_light), tangent.dot(to_eye));
    (sine(light) * sine(eye) - light * eye).max(0.0).powf(exponent)
}

fn sine(cosine: f32) -> f32 {
    (1.0 - cosine * cosine).max(0.0).sqrt()
}
