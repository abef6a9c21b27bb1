//! Textures of a document as materials use them, and their encoded images.

use std::collections::HashMap;

use glam::{Affine2, Vec2};
use lovelock_gltf::ImageFiles;
use lovelock_gltf::document::{Document, TextureInfo};
use serde_json::Value;

use crate::look::{Encoded, Looks};
use crate::{TextureUse, Wrap};

/// Largest file of an image, bytes.
const IMAGE_FILE_BYTES: u64 = 256 << 20;
/// Most bytes of the files of all images.
const IMAGE_FILES_BYTES: u64 = 1 << 30;

/// The textures and images that materials use, in the order in which they are met.
pub(super) struct Textures<'a> {
    pub(super) document: &'a Document,
    files: ImageFiles<'a>,
    pub(super) looks: Looks<'a>,
    images: HashMap<usize, usize>,
    file_bytes: u64,
    /// How often a texture has a transform that is not used.
    pub(super) transforms_left_out: usize,
}

impl<'a> Textures<'a> {
    pub(super) fn new(document: &'a Document, files: ImageFiles<'a>) -> Self {
        Self {
            document,
            files,
            looks: Looks::default(),
            images: HashMap::new(),
            file_bytes: 0,
            transforms_left_out: 0,
        }
    }

    /// The texture that a material refers to; `None` if there is none or its texture coordinates are beyond the second set.
    pub(super) fn texture(&mut self, info: &TextureInfo) -> Option<TextureUse> {
        let transform = info.extensions.get("KHR_texture_transform");
        let set = transform.and_then(|of| of.get("texCoord")).and_then(Value::as_u64);
        let set = set.and_then(|set| usize::try_from(set).ok()).unwrap_or(info.tex_coord);
        if set > 1 {
            self.looks.leave_out_set();
            return None;
        }
        let texture = self.texture_of(info.index, transform.map_or(Affine2::IDENTITY, texture_transform))?;
        Some(TextureUse { set, ..texture })
    }

    /// A texture by its number, with the first texture coordinates.
    pub(super) fn texture_of(&mut self, index: usize, transform: Affine2) -> Option<TextureUse> {
        let texture = self.document.textures.get(index)?;
        let source_of = |name: &str| {
            let source = texture.extensions.get(name)?.get("source")?.as_u64()?;
            usize::try_from(source).ok()
        };
        let image = source_of("EXT_texture_webp").or(texture.source);
        let image = image.or_else(|| source_of("KHR_texture_basisu"));
        let image =
            image.or_else(|| source_of("MSFT_texture_dds")).or_else(|| source_of("EXT_texture_avif"))?;
        let sampler = texture.sampler.and_then(|sampler| self.document.samplers.get(sampler));
        let wrap = |mode: Option<u32>| match mode {
            Some(33071) => Wrap::Clamp,
            Some(33648) => Wrap::Mirror,
            _ => Wrap::Repeat,
        };
        let image = self.image(image);
        Some(TextureUse {
            image,
            set: 0,
            transform: self.usable(transform),
            wrap: sampler.map_or([Wrap::Repeat; 2], |of| [wrap(of.wrap_s), wrap(of.wrap_t)]),
            is_nearest: sampler.is_some_and(|of| of.mag_filter == Some(9728)),
        })
    }

    /// A transform, or none where it is too large to compute with.
    fn usable(&mut self, transform: Affine2) -> Affine2 {
        if TextureUse::can_place(&transform) {
            return transform;
        }
        self.transforms_left_out += 1;
        Affine2::IDENTITY
    }

    /// Number of an image among the encoded ones.
    fn image(&mut self, index: usize) -> usize {
        if let Some(&known) = self.images.get(&index) {
            return known;
        }
        let limit = IMAGE_FILE_BYTES.min(IMAGE_FILES_BYTES.saturating_sub(self.file_bytes));
        let bytes = self.files.bytes(index, limit).map_err(|error| format!("cannot be had: {error}"));
        if let Ok(bytes) = &bytes {
            self.file_bytes = self.file_bytes.saturating_add(bytes.len() as u64);
        }
        let new = self.looks.add_image(Encoded { name: self.files.name(index), bytes });
        self.images.insert(index, new);
        new
    }
}

/// A number of a JSON text, if it is one and finite.
pub(super) fn number(value: &Value) -> Option<f32> {
    value.as_f64().map(|number| number as f32).filter(|number| number.is_finite())
}

/// A number from 0 to 1, or the default if it is none.
pub(super) fn share(value: Option<f32>, default: f32) -> f32 {
    value.filter(|value| value.is_finite()).map_or(default, |value| value.clamp(0.0, 1.0))
}

/// The least opacity that is seen: 0 or more, or the default of glTF. Above 1 nothing is seen.
pub(super) fn cutoff(value: Option<f32>) -> f32 {
    value.filter(|value| value.is_finite()).map_or(0.5, |value| value.max(0.0))
}

/// `KHR_texture_transform`: texture coordinates are scaled, then turned counter-clockwise as seen with v downward, then moved.
fn texture_transform(of: &Value) -> Affine2 {
    let pair = |name: &str, default: Vec2| {
        let pair = of.get(name).and_then(Value::as_array);
        pair.and_then(|pair| Some(Vec2::new(number(pair.first()?)?, number(pair.get(1)?)?)))
            .unwrap_or(default)
    };
    let (offset, scale) = (pair("offset", Vec2::ZERO), pair("scale", Vec2::ONE));
    let turn = of.get("rotation").and_then(number).unwrap_or(0.0);
    Affine2::from_scale_angle_translation(scale, -turn, offset)
}

#[cfg(test)]
mod tests {
    use glam::Vec2;
    use serde_json::json;

    use super::texture_transform;

    #[test]
    fn a_texture_transform_does_what_the_specification_shows() {
        // The example of the specification: the image is turned by a quarter and fills the half of each side that ends at the corner.
        let transform = texture_transform(
            &json!({"offset": [0, 1], "rotation": std::f32::consts::FRAC_PI_2, "scale": [0.5, 0.5]}),
        );
        for (from, to) in [([0.0, 0.0], [0.0, 1.0]), ([1.0, 0.0], [0.0, 0.5]), ([0.0, 1.0], [0.5, 1.0])] {
            assert!(transform.transform_point2(Vec2::from(from)).distance(Vec2::from(to)) < 1e-6, "{from:?}");
        }
        // Scale comes first: an uneven one stays along the axes of the texture coordinates.
        let uneven = texture_transform(&json!({"rotation": std::f32::consts::FRAC_PI_2, "scale": [4, 1]}));
        assert!(uneven.transform_point2(Vec2::X).distance(Vec2::new(0.0, -4.0)) < 1e-6);
    }
}
