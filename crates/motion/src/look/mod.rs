//! How the surface of a figure looks while a reader collects it: materials, and the images that they use, still encoded.

mod beside;
mod decode;
mod jpeg;
mod plan;
mod region;

use std::sync::Arc;

use glam::Vec3;
use lovelock_base::words::counted;

pub(crate) use beside::Folder;
pub(crate) use decode::Encoded;
use decode::decode;
pub(crate) use region::{Known, named_region};

use crate::{Alpha, Image, Material, Mesh, Region, Shading, TextureUse};

/// The materials and the decoded images of a body.
#[derive(Default)]
pub(crate) struct Look {
    pub(crate) materials: Vec<Material>,
    pub(crate) images: Arc<[Image]>,
}

/// The materials of a file. Their textures have numbers of encoded images.
#[derive(Default)]
pub(crate) struct Looks<'a> {
    materials: Vec<Drafted>,
    images: Vec<Encoded<'a>>,
    far_sets: usize,
}

/// A material, and who says what it is made of.
struct Drafted {
    material: Material,
    region: Known,
    painted: Option<Vec3>,
}

impl<'a> Looks<'a> {
    /// Adds a material with its region and returns its number; the first one again if there are too many.
    pub(crate) fn add(&mut self, material: Material, region: Known) -> u16 {
        let Ok(index) = u16::try_from(self.materials.len()) else { return 0 };
        let of = match region {
            Known::Stated(of) | Known::Named(of) => of,
            Known::No => Region::default(),
        };
        self.materials.push(Drafted { material: Material { region: of, ..material }, region, painted: None });
        index
    }

    /// Adds a material as [`Looks::add`] does. Where its image of colour is there, the vertices of its triangles, which no other material
    /// has, get the colour `painted`: an image stands in the place of the stated colour.
    pub(crate) fn add_painted(&mut self, material: Material, region: Known, painted: Vec3) -> u16 {
        let index = self.add(material, region);
        if let Some(drafted) = self.materials.get_mut(usize::from(index)) {
            drafted.painted = Some(painted);
        }
        index
    }

    /// Counts a texture that is left out because its texture coordinates are beyond the second set.
    pub(crate) fn leave_out_set(&mut self) {
        self.far_sets += 1;
    }

    /// Adds an encoded image and returns its number.
    pub(crate) fn add_image(&mut self, image: Encoded<'a>) -> usize {
        self.images.push(image);
        self.images.len() - 1
    }

    /// Decodes the images and leaves out what they lack. A figure of which nothing is said but colours has no materials, so that it
    /// is drawn with the default one.
    pub(crate) fn finish(self, mesh: &mut Mesh, notes: &mut Vec<String>) -> Look {
        let (images, place) = decode(&self.images, notes);
        let mut materials: Vec<Material> = Vec::with_capacity(self.materials.len());
        let mut is_plain = true;
        let mut unseen = Vec::new();
        let mut painted_with = vec![None; self.materials.len()];
        for Drafted { mut material, region, painted } in self.materials {
            let has_texture = textures_of(&mut material).next().is_some();
            // Of a painted surface that no name describes nobody knows that it is skin.
            if region == Known::No && (has_texture || material.shading != Shading::Lit) {
                material.region = Region::Other;
            }
            let placed = |of: TextureUse| {
                place.get(of.image).copied().flatten().map(|image| TextureUse { image, ..of })
            };
            material.base = material.base.and_then(placed);
            if let Some(base) = material.base {
                painted_with[materials.len()] = painted;
                if !is_seen(&images[base.image], material.alpha) {
                    unseen.push(material.name.clone());
                }
            }
            material.normal = material.normal.and_then(|(of, scale)| Some((placed(of)?, scale)));
            if let Some(glow) = material.emissive_texture.take() {
                material.emissive_texture = placed(glow);
                // Without its image all of the surface would shine.
                if material.emissive_texture.is_none() {
                    material.emissive = Vec3::ZERO;
                }
            }
            material.roughness_texture = material.roughness_texture.and_then(placed);
            if let Shading::Toon(toon) = &mut material.shading {
                toon.shade_texture = toon.shade_texture.and_then(placed);
            }
            is_plain &= !has_texture
                && !matches!(region, Known::Stated(_))
                && material.region == Region::Skin
                && material.alpha == Alpha::Opaque
                && material.shading == Shading::Lit
                && material.emissive == Vec3::ZERO;
            materials.push(material);
        }
        paint(mesh, &painted_with);
        if self.far_sets > 0 {
            let textures = counted(self.far_sets, "texture uses", "textures use");
            notes.push(format!(
                "{textures} texture coordinates beyond the second set, which are not read, and are left out"
            ));
        }
        if let Some(first) = unseen.first() {
            let more = match unseen.len() - 1 {
                0 => String::new(),
                more => format!("; {} too", counted(more, "more material is", "more materials are")),
            };
            notes.push(format!("the material `{first}` is invisible: its image has no opaque pixel{more}"));
        }
        if is_plain {
            mesh.materials = Vec::new();
            return Look::default();
        }
        Look { materials, images: images.into() }
    }
}

/// Whether some pixel of an image of colour is seen: a twentieth as opaque as can be where the surface blends, otherwise as much as the
/// mask asks for.
fn is_seen(image: &Image, alpha: Alpha) -> bool {
    let least = match alpha {
        Alpha::Opaque => return true,
        // A mask above 1 hides its material by itself.
        Alpha::Mask(cutoff) if cutoff > 1.0 => return true,
        Alpha::Mask(cutoff) => cutoff * 255.0,
        Alpha::Blend => 0.05 * 255.0,
    };
    image.pixels.as_chunks::<4>().0.iter().any(|pixel| f32::from(pixel[3]) >= least)
}

/// Gives the vertices of triangles of some materials their colour.
fn paint(mesh: &mut Mesh, painted_with: &[Option<Vec3>]) {
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let material = mesh.materials.get(t).map_or(0, |&material| usize::from(material));
        let Some(&Some(color)) = painted_with.get(material) else { continue };
        for &vertex in triangle {
            if let Some(own) = mesh.colors.get_mut(vertex as usize) {
                *own = color;
            }
        }
    }
}

/// The textures of a material.
fn textures_of(material: &mut Material) -> impl Iterator<Item = &mut TextureUse> {
    let shade = match &mut material.shading {
        Shading::Toon(toon) => toon.shade_texture.as_mut(),
        Shading::Lit | Shading::Unlit => None,
    };
    let normal = material.normal.as_mut().map(|(of, _)| of);
    let (emissive, rough) = (material.emissive_texture.as_mut(), material.roughness_texture.as_mut());
    [material.base.as_mut(), normal, emissive, rough, shade].into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;
    use std::io::Cursor;

    use glam::Affine2;

    use super::*;
    use crate::Wrap;

    fn png(alpha: u8) -> Encoded<'static> {
        let image = image::RgbaImage::from_pixel(2, 2, image::Rgba([9, 9, 9, alpha]));
        let mut bytes = Vec::new();
        image.write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
        Encoded { name: "a.png".to_owned(), bytes: Ok(Cow::Owned(bytes)) }
    }

    /// The colour of the vertices and the notes of a figure with one image of colour that also shines.
    fn finished(image: Encoded<'static>, alpha: Alpha) -> (Vec3, Vec3, Vec<String>) {
        let mut looks = Looks::default();
        let of = TextureUse {
            image: looks.add_image(image),
            set: 0,
            transform: Affine2::IDENTITY,
            wrap: [Wrap::Repeat; 2],
            is_nearest: false,
        };
        let material = Material {
            name: "Face".to_owned(),
            base: Some(of),
            emissive: Vec3::ONE,
            emissive_texture: Some(of),
            alpha,
            ..Material::default()
        };
        looks.add_painted(material, Known::No, Vec3::ONE);
        looks.leave_out_set();
        let mut mesh = Mesh {
            triangles: vec![[0, 1, 2]],
            materials: vec![0],
            colors: vec![Vec3::X; 3],
            ..Mesh::default()
        };
        let mut notes = Vec::new();
        let look = looks.finish(&mut mesh, &mut notes);
        (mesh.colors[2], look.materials[0].emissive, notes)
    }

    #[test]
    fn an_image_stands_in_place_of_the_colour_where_it_can_be_decoded() {
        let (color, light, notes) = finished(png(255), Alpha::Blend);
        assert_eq!((color, light, notes.len()), (Vec3::ONE, Vec3::ONE, 1), "{notes:?}");
        assert!(notes[0].contains("beyond the second set"), "{notes:?}");
        let tga = Encoded { name: "skin.TGA".to_owned(), bytes: Ok(Cow::Owned(vec![0, 0, 2, 0, 0])) };
        let (color, light, notes) = finished(tga, Alpha::Opaque);
        assert_eq!((color, light), (Vec3::X, Vec3::ZERO));
        assert!(notes[0].contains("in TGA"), "{notes:?}");
    }

    #[test]
    fn materials_without_an_opaque_pixel_are_told() {
        for (opacity, alpha, is_told) in [
            (0, Alpha::Blend, true),
            (90, Alpha::Blend, false),
            (90, Alpha::Mask(0.5), true),
            (200, Alpha::Mask(0.5), false),
            (0, Alpha::Opaque, false),
        ] {
            let (.., notes) = finished(png(opacity), alpha);
            let found = notes.iter().any(|note| note.contains("`Face` is invisible"));
            assert_eq!(found, is_told, "{opacity} {alpha:?}: {notes:?}");
        }
    }
}
