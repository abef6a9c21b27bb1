//! `MToon`, the drawn look of VRM: base colour, colour in shade, and the ramp between them. Outlines and textures of
//! reflections and of rim light are left out.

use glam::{Affine2, Vec2, Vec3};
use lovelock_gltf::document::{Material as Entry, TextureInfo};
use serde::Deserialize as _;
use serde_json::Value;

use super::textures::{Textures, cutoff, number, share};
use crate::{Alpha, Material, Shading, Toon, ToonRim};

/// A material with the factors of its colour and opacity, which become those of vertices.
pub(super) struct Found {
    pub(super) color: Vec3,
    pub(super) opacity: f32,
    pub(super) material: Material,
}

/// What a material has and is not drawn.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lost {
    pub(super) outlines: bool,
    /// Textures of reflections (`matcap`) or of rim light.
    pub(super) rim_textures: bool,
}

/// The highest power of rim light: above it nothing is left.
const MAX_POWER: f32 = 1000.0;

/// Changes a material by what VRM says of it.
pub(super) fn read(textures: &mut Textures, index: usize, entry: &Entry, found: &mut Found) -> Lost {
    if let Some(of) = entry.extensions.get("VRMC_materials_mtoon") {
        return read_1(textures, of, found);
    }
    let properties = textures.document.extensions.get("VRM").and_then(|vrm| vrm.get("materialProperties"));
    properties.and_then(|all| all.get(index)).map_or_else(Lost::default, |of| read_0(textures, of, found))
}

/// `VRMC_materials_mtoon` of VRM 1.0.
fn read_1(textures: &mut Textures, of: &Value, found: &mut Found) -> Lost {
    let info = of.get("shadeMultiplyTexture").and_then(|info| TextureInfo::deserialize(info).ok());
    found.material.shading = Shading::Toon(Toon {
        shade: color(&of["shadeColorFactor"]).unwrap_or(Vec3::ZERO),
        shade_texture: info.and_then(|info| textures.texture(&info)),
        shift: number(&of["shadingShiftFactor"]).unwrap_or(0.0).clamp(-1.0, 1.0),
        toony: share(number(&of["shadingToonyFactor"]), 0.9),
        rim: ToonRim {
            color: color(&of["parametricRimColorFactor"]).unwrap_or(Vec3::ZERO),
            power: number(&of["parametricRimFresnelPowerFactor"]).unwrap_or(5.0).clamp(0.0, MAX_POWER),
            lift: share(number(&of["parametricRimLiftFactor"]), 0.0),
            lit: share(number(&of["rimLightingMixFactor"]), 1.0),
        },
    });
    let mode = of["outlineWidthMode"].as_str().unwrap_or("none");
    Lost {
        outlines: mode != "none" && number(&of["outlineWidthFactor"]).unwrap_or(0.0) > 0.0,
        rim_textures: ["matcapTexture", "rimMultiplyTexture"].iter().any(|name| of[name].is_object()),
    }
}

/// An element of `materialProperties` of VRM 0.x: the properties of a material of Unity, whose colours are sRGB.
fn read_0(textures: &mut Textures, of: &Value, found: &mut Found) -> Lost {
    let shader = of["shader"].as_str().unwrap_or_default();
    let is_toon = shader == "VRM/MToon";
    let is_unlit = shader.starts_with("VRM/Unlit") || shader.starts_with("Unlit/");
    if !is_toon && !is_unlit {
        return Lost::default();
    }
    let float = |name: &str| number(&of["floatProperties"][name]);
    let vector = |name: &str| &of["vectorProperties"][name];
    if let Some(base) = color(vector("_Color")) {
        found.color = linear(base);
        found.opacity = number(&vector("_Color")[3]).unwrap_or(1.0);
    }
    // Texture coordinates of Unity count from below.
    let placed = |at: &Value| {
        let [x, y, sx, sy] = [0, 1, 2, 3].map(|k| number(&at[k]).unwrap_or(if k < 2 { 0.0 } else { 1.0 }));
        Affine2::from_scale_angle_translation(Vec2::new(sx, sy), 0.0, Vec2::new(x, 1.0 - y - sy))
    };
    let transform = placed(vector("_MainTex"));
    let mut texture = |name: &str| {
        let index = of["textureProperties"][name].as_u64().and_then(|index| usize::try_from(index).ok());
        index.and_then(|index| textures.texture_of(index, transform))
    };
    let material = &mut found.material;
    material.base = texture("_MainTex").or(material.base);
    if is_unlit {
        material.shading = Shading::Unlit;
        if shader.contains("Cutout") {
            material.alpha = Alpha::Mask(cutoff(float("_Cutoff")));
        } else if shader.contains("Transparent") {
            material.alpha = Alpha::Blend;
        }
        return Lost::default();
    }
    if let Some(bumps) = texture("_BumpMap") {
        material.normal = Some((bumps, float("_BumpScale").unwrap_or(1.0)));
    }
    if let Some(emissive) = color(vector("_EmissionColor")) {
        material.emissive = emissive;
        material.emissive_texture = texture("_EmissionMap").or(material.emissive_texture);
    }
    material.alpha = match float("_BlendMode").map(|mode| mode as i32) {
        Some(0) => Alpha::Opaque,
        Some(1) => Alpha::Mask(cutoff(float("_Cutoff"))),
        Some(2..) => Alpha::Blend,
        _ => material.alpha,
    };
    if let Some(culled) = float("_CullMode") {
        material.is_double_sided = culled == 0.0;
    }
    let (shift, toony) = ramp_of_1(float("_ShadeShift").unwrap_or(0.0), float("_ShadeToony").unwrap_or(0.9));
    material.shading = Shading::Toon(Toon {
        shade: color(vector("_ShadeColor")).map_or(Vec3::ZERO, linear),
        shade_texture: texture("_ShadeTexture"),
        shift,
        toony,
        rim: ToonRim {
            color: color(vector("_RimColor")).map_or(Vec3::ZERO, linear),
            power: float("_RimFresnelPower").unwrap_or(1.0).clamp(0.0, MAX_POWER),
            lift: share(float("_RimLift"), 0.0),
            lit: share(float("_RimLightingMix"), 0.0),
        },
    });
    let images = &of["textureProperties"];
    Lost {
        outlines: float("_OutlineWidthMode").unwrap_or(0.0) > 0.0
            && float("_OutlineWidth").unwrap_or(0.0) > 0.0,
        rim_textures: ["_SphereAdd", "_RimTexture"].iter().any(|name| images[name].is_u64()),
    }
}

/// The shift and the sharpness of VRM 1.0 for those of VRM 0.x, whose ramp goes from the shift to a point between it and 1, as `UniVRM`
/// converts them (`MToon10Migrator`).
fn ramp_of_1(shift: f32, toony: f32) -> (f32, f32) {
    let (from, to) = (shift, 1.0 + (shift - 1.0) * toony);
    ((-0.5 * (from + to)).clamp(-1.0, 1.0), (0.5 * (2.0 - (to - from))).clamp(0.0, 1.0))
}

/// Three numbers, each 0 or more.
fn color(value: &Value) -> Option<Vec3> {
    let [r, g, b] = [0, 1, 2].map(|k| value.get(k).and_then(number));
    Some(Vec3::new(r?, g?, b?).max(Vec3::ZERO))
}

/// Linear values of an sRGB colour (IEC 61966-2-1).
fn linear(color: Vec3) -> Vec3 {
    color.map(|c| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) })
}

#[cfg(test)]
mod tests {
    use super::ramp_of_1;

    #[test]
    fn ramps_of_vrm_0_begin_and_end_where_those_of_vrm_1_do() {
        // VRM 1.0: from -1 + toony to 1 - toony, moved by the shift.
        for (shift, toony) in [(0.0, 0.9), (-0.3, 0.5), (0.2, 1.0), (0.0, 0.0)] {
            let (new_shift, new_toony) = ramp_of_1(shift, toony);
            let (from, to) = (-1.0 + new_toony - new_shift, 1.0 - new_toony - new_shift);
            let end = 1.0 + (shift - 1.0) * toony;
            assert!((from - shift).abs() < 1e-6 && (to - end).abs() < 1e-6, "{shift} {toony}: {from} {to}");
        }
    }
}
