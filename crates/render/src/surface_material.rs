//! How a material answers to light, as numbers that both backends use.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lovelock_motion::{Material, Region, Shading};
use lovelock_picture::BodyLook;

/// How far light spreads below skin at a scattering of 1, as a cosine: red light travels furthest.
const SKIN_SPREAD: Vec3 = Vec3::new(0.42, 0.2, 0.13);
/// The white of an eye scatters all colours.
const EYE_SPREAD: Vec3 = Vec3::new(0.3, 0.24, 0.22);
/// Cloth is rough at the scale of its threads, which lets light in at the edge of shade.
const CLOTH_SPREAD: Vec3 = Vec3::splat(0.08);
/// The reflectance of skin, which has a refractive index of about 1.4, of the cornea (1.376) and of plastics (1.5), seen along the normal.
const SKIN_REFLECTANCE: f32 = 0.028;
const EYE_REFLECTANCE: f32 = 0.025;
const OTHER_REFLECTANCE: f32 = 0.04;
/// Lobes of smoother surfaces would show lights, which have no size, as single pixels.
pub(crate) const LEAST_ROUGHNESS: f32 = 0.08;
/// The roughness of a wet cornea. A smoother one would show lights, which have no size, as single pixels.
const CORNEA: f32 = 0.2;
/// The second lobe of skin, the oil on it: its roughness as a part of the first, and its share.
const OIL: [f32; 2] = [0.55, 0.25];
/// The share of light that fibres standing off cloth reflect where it is seen along the surface.
const CLOTH_RIM: f32 = 0.35;

/// The highest power of the rim of a drawing, to which the powers of the CPU are exact.
const MAX_RIM_POWER: f32 = 80.0;

/// The model of a surface that is seen as it is.
pub(crate) const UNLIT: u32 = 1;
/// The model of a drawing.
pub(crate) const TOON: u32 = 2;

/// A material. Twin of `SurfaceMaterial` in `material_shading.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SurfaceMaterial {
    /// Multiplies the colour.
    pub tint: Vec3,
    /// [`UNLIT`], [`TOON`], or 0 for a surface that reflects light.
    pub model: u32,
    /// How far light reaches around the surface past its edge, as a cosine, 0..=1.
    pub spread: Vec3,
    /// Reflectance along the normal; 0 reflects no highlights at all.
    pub reflectance: f32,
    /// Perceptual roughness of both lobes.
    pub roughness: [f32; 2],
    /// The share of the second one.
    pub second: f32,
    /// The share of light that is reflected softly where the surface is seen along it.
    pub rim: f32,
    /// See [`lovelock_motion::Toon`].
    pub shift: f32,
    pub toony: f32,
    /// See [`lovelock_motion::ToonRim`].
    pub rim_lift: f32,
    pub rim_lit: f32,
    pub rim_color: Vec3,
    pub rim_power: f32,
    /// 1 if a texture multiplies the roughness.
    pub is_rough_by_texture: u32,
    pub unused: [u32; 3],
}

impl SurfaceMaterial {
    /// A material of a body that looks as `look` says.
    pub fn new(material: &Material, look: &BodyLook) -> Self {
        let roughness = |by: f32| (material.roughness.clamp(0.0, 1.0) * by).clamp(LEAST_ROUGHNESS, 1.0);
        let made = match material.region {
            Region::Skin => {
                let first = roughness(look.skin_roughness);
                Self {
                    tint: look.skin_tone,
                    spread: (SKIN_SPREAD * look.scattering).min(Vec3::ONE),
                    reflectance: SKIN_REFLECTANCE,
                    roughness: [first, (first * OIL[0]).max(LEAST_ROUGHNESS)],
                    second: OIL[1],
                    ..Self::default()
                }
            }
            Region::Eye => Self {
                tint: Vec3::ONE,
                spread: EYE_SPREAD,
                reflectance: EYE_REFLECTANCE,
                roughness: [CORNEA; 2],
                ..Self::default()
            },
            Region::Cloth => Self {
                tint: look.cloth_color,
                spread: CLOTH_SPREAD,
                roughness: [1.0; 2],
                rim: CLOTH_RIM,
                ..Self::default()
            },
            Region::Other => Self {
                tint: Vec3::ONE,
                reflectance: OTHER_REFLECTANCE,
                roughness: [roughness(1.0); 2],
                ..Self::default()
            },
        };
        let is_rough_by_texture = u32::from(material.roughness_texture.is_some());
        match material.shading {
            Shading::Lit => Self { is_rough_by_texture, ..made },
            Shading::Unlit => Self { tint: made.tint, model: UNLIT, roughness: [1.0; 2], ..Self::default() },
            Shading::Toon(toon) => Self {
                tint: made.tint,
                model: TOON,
                roughness: [1.0; 2],
                shift: toon.shift.clamp(-1.0, 1.0),
                toony: toon.toony.clamp(0.0, 1.0),
                rim_lift: toon.rim.lift.clamp(0.0, 1.0),
                rim_lit: toon.rim.lit.clamp(0.0, 1.0),
                rim_color: toon.rim.color,
                // A power of 0 has no value where the surface is seen along its normal.
                rim_power: toon.rim.power.clamp(1e-5, MAX_RIM_POWER),
                ..Self::default()
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use lovelock_gpu::layout_in_shader;

    use super::*;
    use crate::all_shaders;

    #[test]
    fn the_material_has_the_layout_of_the_shader() {
        let found = all_shaders().into_iter().find(|(label, _)| label == "picture with materials");
        let (_, source) = found.expect("the shader");
        assert_eq!(
            layout_in_shader(&source, "SurfaceMaterial"),
            [
                offset_of!(SurfaceMaterial, tint),
                offset_of!(SurfaceMaterial, model),
                offset_of!(SurfaceMaterial, spread),
                offset_of!(SurfaceMaterial, reflectance),
                offset_of!(SurfaceMaterial, roughness),
                offset_of!(SurfaceMaterial, second),
                offset_of!(SurfaceMaterial, rim),
                offset_of!(SurfaceMaterial, shift),
                offset_of!(SurfaceMaterial, toony),
                offset_of!(SurfaceMaterial, rim_lift),
                offset_of!(SurfaceMaterial, rim_lit),
                offset_of!(SurfaceMaterial, rim_color),
                offset_of!(SurfaceMaterial, rim_power),
                offset_of!(SurfaceMaterial, is_rough_by_texture),
                size_of::<SurfaceMaterial>(),
            ]
        );
    }

    #[test]
    fn settings_change_skin_and_cloth_alone() {
        let look = BodyLook {
            skin_tone: Vec3::new(0.5, 0.4, 0.3),
            skin_roughness: 0.5,
            scattering: 2.0,
            cloth_color: Vec3::X,
        };
        let of = |region, look: &BodyLook| {
            SurfaceMaterial::new(&Material { region, roughness: 0.6, ..Material::default() }, look)
        };
        let usual = BodyLook::default();
        for region in [Region::Eye, Region::Other] {
            assert_eq!(of(region, &look), of(region, &usual), "{region:?}");
        }
        let skin = of(Region::Skin, &look);
        assert_eq!((skin.tint, skin.roughness[0]), (look.skin_tone, 0.3));
        assert!((skin.spread - 2.0 * of(Region::Skin, &usual).spread).length() < 1e-6);
        assert_eq!(of(Region::Cloth, &look).tint, Vec3::X);
    }
}
