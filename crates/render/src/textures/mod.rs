//! The textures of a body: one chart for both backends. The CPU looks them up as [`lookup`] defines, and the graphics card gets the same
//! levels and samplers of the same kind.

mod chain;
mod lookup;
mod wanted;

use std::sync::{Arc, Mutex, PoisonError, Weak};

use glam::{Affine2, Vec3};
use lovelock_motion::{Alpha, Body, Image, Material, Shading, TextureUse};
use rayon::prelude::*;

pub(crate) use chain::{Chain, Content};
pub(crate) use lookup::{Sampling, coordinate, level_of_detail, share};
use wanted::{CHAIN_BYTES, Wanted};

/// A texture of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Texture {
    /// Index into [`BodyTextures::chains`].
    pub chain: usize,
    /// Which coordinates of the mesh are used, 0 or 1.
    pub set: usize,
    /// Maps them to the image.
    pub transform: Affine2,
    pub sampling: Sampling,
}

/// The textures of a material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct MaterialTextures {
    /// Colour and opacity.
    pub base: Option<Texture>,
    /// Normals, and the factor of their slope.
    pub normal: Option<(Texture, f32)>,
    /// Light that is given off.
    pub emissive: Option<Texture>,
    /// Colour in shade.
    pub shade: Option<Texture>,
    /// Factors of the roughness, in green.
    pub roughness: Option<Texture>,
}

/// Textures that a material may have.
pub(crate) const USES: usize = 5;

impl MaterialTextures {
    /// All of them, in the order of `material_draw.wgsl`.
    pub fn uses(&self) -> [Option<&Texture>; USES] {
        [
            self.base.as_ref(),
            self.normal.as_ref().map(|(texture, _)| texture),
            self.emissive.as_ref(),
            self.shade.as_ref(),
            self.roughness.as_ref(),
        ]
    }
}

/// The materials of a body and their textures. Parts without a material have the last one, which is the default.
#[derive(Debug)]
pub(crate) struct BodyTextures {
    images: Arc<[Image]>,
    has_coordinates: [bool; 2],
    pub materials: Vec<Material>,
    pub chains: Vec<Chain>,
    /// The textures of each material.
    pub of: Vec<MaterialTextures>,
}

impl BodyTextures {
    /// Whether a body has materials: otherwise it is drawn without.
    pub fn are_in(body: &Body) -> bool {
        !body.mesh.materials.is_empty() && !body.materials.is_empty()
    }

    /// Those of a body, which bodies with the same images and materials share while any of them is drawn. `None` if the body has no
    /// materials.
    pub fn of(body: &Body) -> Option<Arc<Self>> {
        static SHARED: Mutex<Vec<Weak<BodyTextures>>> = Mutex::new(Vec::new());
        if !Self::are_in(body) {
            return None;
        }
        let count = body.mesh.positions.len();
        let has_coordinates =
            body.mesh.coordinates.each_ref().map(|set| !set.is_empty() && set.len() == count);
        let materials: Vec<Material> =
            body.materials.iter().cloned().chain([Material::default()]).map(with_numbers).collect();
        let is_same = |shared: &Arc<Self>| {
            Arc::ptr_eq(&shared.images, &body.images)
                && shared.has_coordinates == has_coordinates
                && shared.materials == materials
        };
        // Locked while they are made, so that several renderers do not make the same.
        let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
        shared.retain(|known| known.strong_count() > 0);
        if let Some(known) = shared.iter().filter_map(Weak::upgrade).find(is_same) {
            return Some(known);
        }
        let made = Arc::new(Self::new(body, materials, has_coordinates));
        shared.push(Arc::downgrade(&made));
        Some(made)
    }

    fn new(body: &Body, materials: Vec<Material>, has_coordinates: [bool; 2]) -> Self {
        let mut wanted = Wanted::new(CHAIN_BYTES);
        let mut texture = |asked: &TextureUse, content: Content| -> Option<Texture> {
            if asked.image >= body.images.len() || !*has_coordinates.get(asked.set)? {
                return None;
            }
            let chain = wanted.chain(asked.image, body.images[asked.image].size, content);
            let sampling = Sampling { wrap: asked.wrap, is_nearest: asked.is_nearest };
            Some(Texture { chain, set: asked.set, transform: asked.transform, sampling })
        };
        let of = materials
            .iter()
            .map(|material| {
                let color = match material.alpha {
                    Alpha::Opaque => Content::Color,
                    Alpha::Mask(cutoff) => Content::mask(cutoff),
                    Alpha::Blend => Content::ColorByOpacity,
                };
                let toon = if let Shading::Toon(toon) = material.shading { Some(toon) } else { None };
                let normal = material.normal.as_ref();
                MaterialTextures {
                    base: material.base.as_ref().and_then(|asked| texture(asked, color)),
                    normal: normal.and_then(|(asked, by)| Some((texture(asked, Content::Data)?, *by))),
                    emissive: (material.emissive_texture.as_ref())
                        .and_then(|asked| texture(asked, Content::Color)),
                    shade: toon.and_then(|toon| texture(&toon.shade_texture?, color)),
                    roughness: (material.roughness_texture.as_ref())
                        .and_then(|asked| texture(asked, Content::Data)),
                }
            })
            .collect();
        let chains =
            wanted.chains.par_iter().map(|&(image, content)| Chain::new(&body.images[image], content));
        Self { images: Arc::clone(&body.images), has_coordinates, chains: chains.collect(), materials, of }
    }

    /// The material of a triangle.
    pub fn material_of(&self, body: &Body, triangle: usize) -> usize {
        let default = self.materials.len() - 1;
        body.mesh.materials.get(triangle).map_or(default, |&material| usize::from(material).min(default))
    }

    /// The memory of the levels that were made, bytes.
    pub fn bytes(&self) -> u64 {
        self.chains.iter().map(Chain::own_bytes).sum()
    }
}

/// A material with usual numbers in place of what is none.
fn with_numbers(mut material: Material) -> Material {
    let number = |value: f32, usual: f32| if value.is_finite() { value } else { usual };
    let light =
        |color: Vec3| if color.is_finite() { color.clamp(Vec3::ZERO, MAX_EMISSIVE) } else { Vec3::ZERO };
    let placed = |texture: &mut Option<TextureUse>| {
        if let Some(texture) = texture.as_mut().filter(|texture| !TextureUse::can_place(&texture.transform)) {
            texture.transform = Affine2::IDENTITY;
        }
    };
    material.roughness = number(material.roughness, 0.5);
    material.emissive = light(material.emissive);
    placed(&mut material.base);
    placed(&mut material.emissive_texture);
    placed(&mut material.roughness_texture);
    if let Some((texture, slope)) = &mut material.normal {
        *slope = number(*slope, 1.0);
        if !TextureUse::can_place(&texture.transform) {
            texture.transform = Affine2::IDENTITY;
        }
    }
    if let Shading::Toon(toon) = &mut material.shading {
        // A colour of a surface is 1 at most, which is also all that the graphics card keeps of it.
        (toon.shade, toon.rim.color) = (light(toon.shade).min(Vec3::ONE), light(toon.rim.color));
        let rim = &mut toon.rim;
        (rim.power, rim.lift, rim.lit) =
            (number(rim.power, 5.0).max(0.0), number(rim.lift, 0.0), number(rim.lit, 1.0));
        (toon.shift, toon.toony) = (number(toon.shift, 0.0), number(toon.toony, 0.9));
        placed(&mut toon.shade_texture);
    }
    if let Alpha::Mask(cutoff) = &mut material.alpha {
        *cutoff = number(*cutoff, 0.5);
    }
    material
}

/// The most light that a surface gives off.
const MAX_EMISSIVE: Vec3 = Vec3::splat(10_000.0);

#[cfg(test)]
mod tests {
    use glam::Vec2;
    use lovelock_motion::{Mesh, Wrap};

    use super::*;

    fn body() -> Body {
        let image = Image { name: "one".to_owned(), size: [1, 1], pixels: Arc::new([9; 4]) };
        let base = TextureUse {
            image: 0,
            set: 0,
            transform: Affine2::IDENTITY,
            wrap: Default::default(),
            is_nearest: false,
        };
        let textured = Material { base: Some(base), ..Material::default() };
        let missing = Material { base: Some(TextureUse { image: 7, ..base }), ..Material::default() };
        let other_set = Material { base: Some(TextureUse { set: 1, ..base }), ..Material::default() };
        let mesh = Mesh {
            positions: vec![Vec3::ZERO; 3],
            coordinates: [vec![Vec2::ZERO; 3], Vec::new()],
            triangles: vec![[0, 1, 2]; 4],
            materials: vec![0, 2, 65535],
            ..Mesh::default()
        };
        let materials = vec![textured, missing, other_set];
        Body { mesh, materials, images: Arc::new([image]), ..Body::default() }
    }

    #[test]
    fn what_is_missing_is_left_out_and_what_has_no_material_has_the_default() {
        let body = body();
        let textures = BodyTextures::of(&body).expect("materials");
        assert!(textures.of[0].base.is_some());
        assert_eq!(textures.of[1].base, None, "no such image");
        assert_eq!(textures.of[2].base, None, "no such coordinates");
        let of = [0, 1, 2, 3, 99].map(|triangle| textures.material_of(&body, triangle));
        assert_eq!(of, [0, 2, 3, 3, 3]);
        assert!(BodyTextures::of(&Body { materials: Vec::new(), ..body }).is_none());
    }

    #[test]
    fn colours_in_shade_and_transforms_have_numbers_that_can_be_drawn() {
        use lovelock_motion::{Toon, ToonRim};
        let placed = |scale: f32| {
            let mut body = body();
            let base = body.materials[0].base.as_mut().expect("a texture");
            base.transform = Affine2::from_scale(Vec2::splat(scale));
            BodyTextures::of(&body).expect("materials").of[0].base.expect("a texture").transform
        };
        assert_eq!(placed(1e30), Affine2::IDENTITY);
        assert_eq!(placed(500.0), Affine2::from_scale(Vec2::splat(500.0)), "the control");
        let rim = ToonRim { color: Vec3::splat(3.0), ..ToonRim::default() };
        let shade = Vec3::new(40.0, 0.5, -1.0);
        let toon = Toon { shade, shade_texture: None, shift: 0.0, toony: 0.9, rim };
        let found = with_numbers(Material { shading: Shading::Toon(toon), ..Material::default() }).shading;
        let wanted = Toon { shade: Vec3::new(1.0, 0.5, 0.0), ..toon };
        assert_eq!(found, Shading::Toon(wanted), "light of the rim may be brighter than 1");
    }

    #[test]
    fn every_use_is_listed() {
        let mut body = body();
        let base = body.materials[0].base;
        // A sampler that nothing else uses.
        let rough = base.map(|base| TextureUse { wrap: [Wrap::Clamp; 2], ..base });
        body.materials[0].roughness_texture = rough;
        let textures = BodyTextures::of(&body).expect("materials");
        let samplings: Vec<_> =
            textures.of[0].uses().into_iter().flatten().map(|of| of.sampling.wrap).collect();
        assert_eq!(samplings, [[Wrap::Repeat; 2], [Wrap::Clamp; 2]]);
    }

    #[test]
    fn bodies_with_the_same_images_and_materials_share_textures() {
        let one = body();
        let mut other = one.clone();
        other.mesh.colors = vec![Vec3::ONE; 3];
        let of_one = BodyTextures::of(&one).expect("materials");
        assert!(Arc::ptr_eq(&of_one, &BodyTextures::of(&other).expect("materials")));
        other.materials[1].roughness = 0.2;
        assert!(!Arc::ptr_eq(&of_one, &BodyTextures::of(&other).expect("materials")));
    }
}
