//! Materials with their textures, embedded or beside the file.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

use glam::{Affine2, Mat2, Vec2, Vec3};
use ufbx::{Mesh, Texture, WrapMode};

use crate::look::{Encoded, Folder, Known, Looks, named_region};
use crate::surface::CLAY;
use crate::{Alpha, Material, Shading, TextureUse, Wrap};

/// What the vertices of a material take from it.
#[derive(Clone, Copy)]
pub(super) struct Coat {
    pub(super) material: u16,
    pub(super) color: Vec3,
}

impl Default for Coat {
    fn default() -> Self {
        Self { material: 0, color: CLAY }
    }
}

/// The materials of a scene, in the order in which meshes use them.
pub(super) struct Materials<'a> {
    folder: Folder<'a>,
    pub(super) looks: Looks<'a>,
    coats: HashMap<Option<u32>, Coat>,
    images: HashMap<u32, usize>,
}

impl<'a> Materials<'a> {
    pub(super) fn new(folder: Option<&'a Path>) -> Self {
        Self {
            folder: Folder::new(folder),
            looks: Looks::default(),
            coats: HashMap::new(),
            images: HashMap::new(),
        }
    }

    /// A material of a mesh; the default one where it has none.
    pub(super) fn coat(&mut self, mesh: &'a Mesh, material: Option<&'a ufbx::Material>, node: &str) -> Coat {
        let key = material.map(|material| material.element.element_id);
        if let Some(&known) = self.coats.get(&key) {
            return known;
        }
        let new = match material {
            None => Coat { material: self.looks.add(Material::default(), Known::No), color: CLAY },
            Some(material) => self.read(mesh, material, node),
        };
        self.coats.insert(key, new);
        new
    }

    fn read(&mut self, mesh: &'a Mesh, of: &'a ufbx::Material, node: &str) -> Coat {
        let diffuse = &of.fbx.diffuse_color;
        let name: &str = &of.element.name;
        let base = diffuse.texture.as_deref().or(of.pbr.base_color.texture.as_deref());
        let base = base.and_then(|texture| self.texture(mesh, texture));
        let value = vector(&diffuse.value_vec4);
        let color = if diffuse.has_value && value.is_finite() { value } else { CLAY };
        let normal = of.fbx.normal_map.texture.as_deref().or(of.pbr.normal_map.texture.as_deref());
        let normal = normal.and_then(|texture| self.texture(mesh, texture));
        let emission = &of.pbr.emission_color;
        let factor =
            if of.pbr.emission_factor.has_value { of.pbr.emission_factor.value_vec4.x as f32 } else { 1.0 };
        let emissive_texture = emission.texture.as_deref().and_then(|texture| self.texture(mesh, texture));
        let light = vector(&emission.value_vec4);
        // A texture stands in the place of a colour that nobody set.
        let light = if emissive_texture.is_some() && light == Vec3::ZERO { Vec3::ONE } else { light };
        let emissive = (light * factor).max(Vec3::ZERO);
        let cut = [&of.fbx.transparency_color, &of.fbx.transparency_factor, &of.pbr.opacity];
        let is_cut = base.is_some() && cut.iter().any(|map| map.texture.is_some() && map.texture_enabled);
        let roughness = &of.pbr.roughness;
        let default = Material::default();
        let stated = roughness.value_vec4.x as f32;
        let region = named_region(&[name, &mesh.element.name, node]);
        let material = Material {
            name: name.chars().take(80).collect(),
            base,
            normal: normal.map(|of| (of, 1.0)),
            emissive: if emissive.is_finite() { emissive } else { Vec3::ZERO },
            emissive_texture,
            alpha: if is_cut { Alpha::Mask(0.5) } else { Alpha::Opaque },
            is_double_sided: of.features.double_sided.enabled,
            shading: if of.features.unlit.enabled { Shading::Unlit } else { Shading::Lit },
            roughness: if roughness.has_value && stated.is_finite() {
                stated.clamp(0.0, 1.0)
            } else {
                default.roughness
            },
            ..default
        };
        // A texture stands in the place of the colour.
        let material = self.looks.add_painted(material, region, Vec3::ONE);
        Coat { material, color: color.clamp(Vec3::ZERO, Vec3::ONE) }
    }

    /// The first file of a texture; `None` also where it uses texture coordinates beyond the second set.
    fn texture(&mut self, mesh: &Mesh, texture: &'a Texture) -> Option<TextureUse> {
        let file = texture.file_textures.first().map_or(texture, |first| &**first);
        let embedded = if file.content.is_empty() {
            file.video.as_ref().map(|video| &video.content)
        } else {
            Some(&file.content)
        };
        let embedded = embedded.filter(|content| !content.is_empty());
        let names = [&file.relative_filename, &file.filename].map(|name| &**name);
        if embedded.is_none() && names.iter().all(|name| name.is_empty()) {
            return None;
        }
        let set =
            mesh.uv_sets.iter().position(|set| !texture.uv_set.is_empty() && set.name == &*texture.uv_set);
        let set = set.unwrap_or(0);
        if set > 1 {
            self.looks.leave_out_set();
            return None;
        }
        let image = if let Some(&known) = self.images.get(&file.element.element_id) {
            known
        } else {
            let shown = names.iter().find(|name| !name.is_empty()).copied().unwrap_or(&file.element.name);
            let shown = shown.rsplit(['/', '\\']).next().unwrap_or(shown);
            let name: String = shown.chars().take(80).collect();
            let looks = &mut self.looks;
            let new = match embedded {
                Some(content) => looks.add_image(Encoded { name, bytes: Ok(Cow::Borrowed(&content[..])) }),
                None => self
                    .folder
                    .image(&names, |bytes| looks.add_image(Encoded { name, bytes: bytes.map(Cow::Owned) })),
            };
            self.images.insert(file.element.element_id, new);
            new
        };
        let wrap = |mode: WrapMode| if mode == WrapMode::Clamp { Wrap::Clamp } else { Wrap::Repeat };
        Some(TextureUse {
            image,
            set,
            transform: if texture.has_uv_transform {
                from_above(&texture.uv_to_texture)
            } else {
                Affine2::IDENTITY
            },
            wrap: [wrap(texture.wrap_u), wrap(texture.wrap_v)],
            is_nearest: false,
        })
    }
}

fn vector(value: &ufbx::Vec4) -> Vec3 {
    Vec3::new(value.x as f32, value.y as f32, value.z as f32)
}

/// A map of texture coordinates that count from below, for those that count from above.
fn from_above(map: &ufbx::Matrix) -> Affine2 {
    let map = Affine2 {
        matrix2: Mat2::from_cols(
            Vec2::new(map.m00 as f32, map.m10 as f32),
            Vec2::new(map.m01 as f32, map.m11 as f32),
        ),
        translation: Vec2::new(map.m03 as f32, map.m13 as f32),
    };
    let flip = Affine2 { matrix2: Mat2::from_diagonal(Vec2::new(1.0, -1.0)), translation: Vec2::Y };
    let flipped = flip * map * flip;
    if TextureUse::can_place(&flipped) { flipped } else { Affine2::IDENTITY }
}
