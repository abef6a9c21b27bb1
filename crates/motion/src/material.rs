//! How the surface of a body looks: its materials and the images that they use.

use std::sync::Arc;

use glam::{Affine2, Vec3};

/// An image that materials use, decoded.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    /// Its name or file.
    pub name: String,
    /// Width and height, pixels; not 0.
    pub size: [u32; 2],
    /// Red, green, blue and alpha of each pixel, row after row from the top. Colours are sRGB, normals as glTF defines them.
    pub pixels: Arc<[u8]>,
}

/// What a texture shows outside of 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image again, every second time mirrored.
    Mirror,
    /// The pixel at the border.
    Clamp,
}

/// An image on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureUse {
    /// Index into [`crate::Body::images`].
    pub image: usize,
    /// Which texture coordinates of the mesh are used, 0 or 1.
    pub set: usize,
    /// Maps texture coordinates to the image, whose top left corner is (0, 0) and whose bottom right corner is (1, 1).
    pub transform: Affine2,
    /// What is seen outside of the image, along its rows and along its columns.
    pub wrap: [Wrap; 2],
    /// Whether the nearest pixel is taken, as for pixel art.
    pub is_nearest: bool,
}

impl TextureUse {
    /// Whether a transform can be computed with: no number of it is beyond 10,000. Larger ones, as broken files have, leave no digits for
    /// places within the image, and overflow.
    pub fn can_place(transform: &Affine2) -> bool {
        // False for NaN.
        transform.to_cols_array().iter().all(|number| number.abs() <= 1e4)
    }
}

/// How the opacity of a surface is used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Alpha {
    /// It is not: the surface is opaque.
    #[default]
    Opaque,
    /// What is less opaque than this is not there; the rest is opaque. Above 1 nothing is there.
    Mask(f32),
    /// The surface covers what is behind it by its opacity.
    Blend,
}

/// Colours of `MToon`: the base colour in light, another in shade, and how one passes into the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toon {
    /// Colour in shade, linear sRGB; multiplies `shade_texture`.
    pub shade: Vec3,
    /// Texture of the colour in shade.
    pub shade_texture: Option<TextureUse>,
    /// Where shade begins, -1..=1 (`shadingShiftFactor` of VRM 1.0).
    pub shift: f32,
    /// How sharply light passes into shade, 0..=1 (`shadingToonyFactor` of VRM 1.0).
    pub toony: f32,
    /// Light along the outline of the figure.
    pub rim: ToonRim,
}

/// The light that a drawing has where it is seen along its surface: `color * saturate(1 - cos + lift)^power` (`parametricRim` of VRM 1.0).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToonRim {
    /// Its colour, linear sRGB; black for none.
    pub color: Vec3,
    /// How fast it fades toward the middle, 0 or more.
    pub power: f32,
    /// Widens it, 0..=1.
    pub lift: f32,
    /// How much of it is multiplied by the light that arrives, 0..=1; the rest is always seen.
    pub lit: f32,
}

/// How a surface answers to light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Shading {
    /// By the shading of its region.
    #[default]
    Lit,
    /// Not at all: its colour is seen as it is.
    Unlit,
    /// As a drawing.
    Toon(Toon),
}

/// What a surface is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Region {
    /// Skin: light scatters below it.
    #[default]
    Skin,
    /// An eye: smooth, with the highlight of the cornea.
    Eye,
    /// Cloth: matt, with a soft rim.
    Cloth,
    /// Anything else: hard and matt.
    Other,
}

/// How a part of a surface looks. The colour that textures multiply is that of the mesh, [`crate::Mesh::colors`].
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file.
    pub name: String,
    /// What it is made of.
    pub region: Region,
    /// Texture of colour (sRGB) and opacity.
    pub base: Option<TextureUse>,
    /// Texture of normals in tangent space, and the factor of their slope.
    pub normal: Option<(TextureUse, f32)>,
    /// Light that it gives off, linear sRGB; multiplies `emissive_texture`.
    pub emissive: Vec3,
    /// Texture (sRGB) of the light that it gives off.
    pub emissive_texture: Option<TextureUse>,
    /// How its opacity is used.
    pub alpha: Alpha,
    /// Whether it is seen from behind too.
    pub is_double_sided: bool,
    /// How it answers to light.
    pub shading: Shading,
    /// Perceptual roughness, 0..=1.
    pub roughness: f32,
    /// Texture whose green multiplies the roughness.
    pub roughness_texture: Option<TextureUse>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            region: Region::default(),
            base: None,
            normal: None,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            alpha: Alpha::default(),
            is_double_sided: false,
            shading: Shading::default(),
            roughness: 0.5,
            roughness_texture: None,
        }
    }
}
