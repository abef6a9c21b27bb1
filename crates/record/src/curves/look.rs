//! How the exported body looks: its triangles by material, and its images as PNG.

use std::io::{self, Cursor};

use glam::Vec3;
use image::{ExtendedColorType, ImageEncoder as _, codecs::png::PngEncoder};
use lovelock_motion::{Image, Material, Shading, TextureUse};

use super::CurveBody;

impl CurveBody {
    /// Whether the fields of its look fit to each other.
    pub(super) fn look_fits(&self) -> bool {
        let (vertices, triangles) = (self.bind_positions.len(), self.triangles.len());
        let fits = |length: usize, all: usize| length == 0 || length == all;
        fits(self.opacity.len(), vertices)
            && self.coordinates.iter().all(|set| fits(set.len(), vertices))
            && fits(self.of_triangles.len(), triangles)
            && self.of_triangles.iter().all(|&material| usize::from(material) < self.materials.len())
            && self.materials.iter().flat_map(textures_of).all(|of| of.image < self.images.len())
    }

    /// The numbers of triangles of each material that some have, in the order of materials; all with `None` if the body has no materials.
    pub(super) fn parts(&self) -> Vec<(Option<usize>, Vec<usize>)> {
        if self.of_triangles.is_empty() {
            return vec![(None, (0..self.triangles.len()).collect())];
        }
        let mut parts: Vec<(Option<usize>, Vec<usize>)> =
            (0..self.materials.len()).map(|material| (Some(material), Vec::new())).collect();
        for (triangle, &material) in self.of_triangles.iter().enumerate() {
            parts[usize::from(material)].1.push(triangle);
        }
        parts.retain(|(_, triangles)| !triangles.is_empty());
        parts
    }

    /// The mean colour of some triangles, linear sRGB.
    pub(super) fn mean_color(&self, triangles: &[usize]) -> Vec3 {
        let corners = triangles.iter().flat_map(|&t| self.triangles[t]);
        let sum: Vec3 = corners.map(|vertex| self.colors[vertex as usize]).sum();
        sum / (3 * triangles.len().max(1)) as f32
    }
}

/// The textures of a material that files have places for.
pub(super) fn textures_of(material: &Material) -> impl Iterator<Item = TextureUse> {
    let normal = material.normal.map(|(of, _)| of);
    [material.base, normal, material.emissive_texture, material.roughness_texture].into_iter().flatten()
}

/// Whether a material is seen as it is, without light: drawn looks have no place in other files either, but are lit.
pub(super) fn is_unlit(material: &Material) -> bool {
    material.shading == Shading::Unlit
}

/// An image as PNG.
pub(super) fn png(image: &Image) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    PngEncoder::new(Cursor::new(&mut bytes))
        .write_image(&image.pixels, image.size[0], image.size[1], ExtendedColorType::Rgba8)
        .map_err(io::Error::other)?;
    Ok(bytes)
}
