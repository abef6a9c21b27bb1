//! What `lovelock info` tells of the surface of a character: materials, textures and expressions.

use serde::{Deserialize, Serialize};

use crate::{Alpha, Body, Expression, Image, Material, Region, Shading, TextureUse};

/// One material of a character.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MaterialInfo {
    /// Its name in the file.
    pub name: String,
    /// What it is made of: `skin`, `eye`, `cloth` or `other`.
    pub region: String,
    /// How it answers to light: `lit`, `unlit` or `toon`.
    pub shading: String,
    /// How its opacity is used: `opaque`, `mask` or `blend`.
    pub alpha: String,
    /// The least opacity that a mask shows; `None` without a mask.
    pub alpha_cutoff: Option<f32>,
    /// Whether it is seen from behind too.
    pub double_sided: bool,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// Triangles that have it.
    pub triangles: usize,
    /// Its textures.
    pub textures: Vec<TextureUseInfo>,
}

/// One use of an image by a material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TextureUseInfo {
    /// What it gives: `color`, `normal`, `roughness`, `emissive` or `shade`.
    pub gives: String,
    /// Index into the textures of the character.
    pub texture: usize,
    /// Which texture coordinates are used, 0 or 1.
    pub coordinates: usize,
}

/// One image of a character.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImageInfo {
    /// Its name or file.
    pub name: String,
    /// Width as it is kept, pixels.
    pub width: u32,
    /// Height as it is kept, pixels.
    pub height: u32,
}

/// One expression of a character.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExpressionInfo {
    /// Its name.
    pub name: String,
    /// Its preset by the name of VRM 1.0; `None` for one of the file's own.
    pub preset: Option<String>,
    /// Whether it is fully shown or not at all.
    pub is_binary: bool,
    /// Number of morph targets that it moves.
    pub morph_targets: usize,
}

/// The materials of a body; none if it has the default one alone.
pub(crate) fn materials(body: &Body) -> Vec<MaterialInfo> {
    let mut triangles = vec![0; body.materials.len()];
    for &material in &body.mesh.materials {
        if let Some(count) = triangles.get_mut(usize::from(material)) {
            *count += 1;
        }
    }
    body.materials
        .iter()
        .zip(triangles)
        .map(|(material, triangles)| of_material(material, triangles))
        .collect()
}

fn of_material(material: &Material, triangles: usize) -> MaterialInfo {
    let region = match material.region {
        Region::Skin => "skin",
        Region::Eye => "eye",
        Region::Cloth => "cloth",
        Region::Other => "other",
    };
    let (shading, shade) = match material.shading {
        Shading::Lit => ("lit", None),
        Shading::Unlit => ("unlit", None),
        Shading::Toon(toon) => ("toon", toon.shade_texture),
    };
    let (alpha, alpha_cutoff) = match material.alpha {
        Alpha::Opaque => ("opaque", None),
        Alpha::Mask(cutoff) => ("mask", Some(cutoff)),
        Alpha::Blend => ("blend", None),
    };
    let uses: [(&str, Option<TextureUse>); 5] = [
        ("color", material.base),
        ("normal", material.normal.map(|(of, _)| of)),
        ("roughness", material.roughness_texture),
        ("emissive", material.emissive_texture),
        ("shade", shade),
    ];
    let texture = |(gives, of): (&str, Option<TextureUse>)| {
        of.map(|of| TextureUseInfo { gives: gives.to_owned(), texture: of.image, coordinates: of.set })
    };
    MaterialInfo {
        name: material.name.clone(),
        region: region.to_owned(),
        shading: shading.to_owned(),
        alpha: alpha.to_owned(),
        alpha_cutoff,
        double_sided: material.is_double_sided,
        roughness: material.roughness,
        triangles,
        textures: uses.into_iter().filter_map(texture).collect(),
    }
}

/// The images of a body.
pub(crate) fn images(images: &[Image]) -> Vec<ImageInfo> {
    let info =
        |image: &Image| ImageInfo { name: image.name.clone(), width: image.size[0], height: image.size[1] };
    images.iter().map(info).collect()
}

/// The expressions of a body.
pub(crate) fn expressions(expressions: &[Expression]) -> Vec<ExpressionInfo> {
    let info = |expression: &Expression| ExpressionInfo {
        name: expression.name.clone(),
        preset: expression.preset.map(ToOwned::to_owned),
        is_binary: expression.is_binary,
        morph_targets: expression.morphs.len(),
    };
    expressions.iter().map(info).collect()
}
