//! Materials of a document: metallic roughness with its textures, unlit, and `MToon`.

use std::collections::HashMap;

use glam::Vec3;
use lovelock_base::words::counted;
use lovelock_gltf::ImageFiles;
use lovelock_gltf::document::{Document, Material as Entry};
use serde_json::Value;

use super::mtoon;
use super::textures::{Textures, cutoff, number, share};
use crate::look::{Known, Look, named_region};
use crate::surface::CLAY;
use crate::{Alpha, Material, Mesh, Region, Shading};

/// What a primitive takes from its material.
#[derive(Clone, Copy)]
pub(super) struct Coat {
    /// Its number.
    pub(super) material: u16,
    /// Colour that multiplies those of vertices, linear sRGB.
    pub(super) color: Vec3,
    /// Opacity that multiplies that of vertices; `None` if opacity is not used.
    pub(super) opacity: Option<f32>,
}

/// The materials that primitives use, in the order in which they are met.
pub(super) struct Materials<'a> {
    textures: Textures<'a>,
    coats: HashMap<Option<usize>, Coat>,
    outlines: usize,
    rim_textures: usize,
    metals: usize,
    occlusions: usize,
}

impl<'a> Materials<'a> {
    pub(super) fn new(document: &'a Document, files: ImageFiles<'a>) -> Self {
        Self {
            textures: Textures::new(document, files),
            coats: HashMap::new(),
            outlines: 0,
            rim_textures: 0,
            metals: 0,
            occlusions: 0,
        }
    }

    /// The material of a primitive, by whose names its region is guessed, from the nearest to the farthest.
    pub(super) fn coat(&mut self, index: Option<usize>, names: &[&str], has_vertex_colors: bool) -> Coat {
        let entry = index.and_then(|index| Some((index, self.textures.document.materials.get(index)?)));
        let key = entry.map(|(index, _)| index);
        let mut coat = if let Some(&known) = self.coats.get(&key) {
            known
        } else {
            let new = match entry {
                Some((index, entry)) => self.read(index, entry, names),
                None => Coat {
                    material: self.textures.looks.add(Material::default(), Known::No),
                    color: Vec3::ONE,
                    opacity: None,
                },
            };
            self.coats.insert(key, new);
            new
        };
        if entry.is_none() && !has_vertex_colors {
            coat.color = CLAY;
        }
        coat
    }

    fn read(&mut self, index: usize, entry: &Entry, names: &[&str]) -> Coat {
        let pbr = &entry.pbr_metallic_roughness;
        let own = entry.name.as_deref().unwrap_or_default();
        let names: Vec<&str> = std::iter::once(own).chain(names.iter().copied()).collect();
        let region = stated_region(&entry.extras).map_or_else(|| named_region(&names), Known::Stated);
        let [r, g, b, a] = pbr.base_color_factor.unwrap_or([1.0; 4]);
        let strength = entry
            .extensions
            .get("KHR_materials_emissive_strength")
            .and_then(|of| number(&of["emissiveStrength"]))
            .unwrap_or(1.0);
        let emissive = Vec3::from(entry.emissive_factor.unwrap_or_default()) * strength.max(0.0);
        let alpha = match entry.alpha_mode.as_deref() {
            Some("MASK") => Alpha::Mask(cutoff(entry.alpha_cutoff)),
            Some("BLEND") => Alpha::Blend,
            _ => Alpha::Opaque,
        };
        let unlit = entry.extensions.get("KHR_materials_unlit").is_some();
        let default = Material::default();
        let textures = &mut self.textures;
        let base = pbr.base_color_texture.as_ref().and_then(|info| textures.texture(info));
        let rough = pbr.metallic_roughness_texture.as_ref().and_then(|info| textures.texture(info));
        let rough_is_there = rough.is_some();
        let mut found = mtoon::Found {
            color: Vec3::new(r, g, b),
            opacity: a,
            material: Material {
                name: own.chars().take(80).collect(),
                base,
                normal: entry.normal_texture.as_ref().and_then(|info| {
                    let scale = info.scale.filter(|scale| scale.is_finite()).unwrap_or(1.0);
                    Some((textures.texture(info)?, scale))
                }),
                emissive: if emissive.is_finite() { emissive.max(Vec3::ZERO) } else { Vec3::ZERO },
                emissive_texture: entry.emissive_texture.as_ref().and_then(|info| textures.texture(info)),
                alpha,
                is_double_sided: entry.double_sided,
                shading: if unlit { Shading::Unlit } else { Shading::Lit },
                roughness: share(pbr.roughness_factor, if rough.is_some() { 1.0 } else { default.roughness }),
                roughness_texture: rough,
                ..default
            },
        };
        let lost = mtoon::read(&mut self.textures, index, entry, &mut found);
        self.outlines += usize::from(lost.outlines);
        self.rim_textures += usize::from(lost.rim_textures);
        // The image of roughness may say metal only where the factor does not say 0.
        let is_metal = rough_is_there && pbr.metallic_factor.unwrap_or(1.0) != 0.0;
        self.metals += usize::from(is_metal);
        self.occlusions += usize::from(entry.occlusion_texture.is_some());
        Coat {
            material: self.textures.looks.add(found.material.clone(), region),
            color: if found.color.is_finite() { found.color } else { Vec3::ONE },
            opacity: match found.material.alpha {
                Alpha::Opaque => None,
                Alpha::Mask(_) | Alpha::Blend => Some(share(Some(found.opacity), 1.0)),
            },
        }
    }

    /// The materials with their decoded images. Notes tell what is left out.
    pub(super) fn finish(self, mesh: &mut Mesh, notes: &mut Vec<String>) -> Look {
        if self.outlines > 0 {
            let materials = counted(self.outlines, "material has", "materials have");
            notes.push(format!("{materials} outlines, which are not drawn"));
        }
        if self.rim_textures > 0 {
            let materials = counted(self.rim_textures, "material has", "materials have");
            notes.push(format!("{materials} textures of reflections or of rim light, which are not drawn"));
        }
        if self.textures.transforms_left_out > 0 {
            let uses = counted(self.textures.transforms_left_out, "texture", "textures");
            notes.push(format!(
                "the transforms of coordinates of {uses} are left out: they have numbers beyond 10,000"
            ));
        }
        for (count, what) in [(self.metals, "of metal"), (self.occlusions, "of occlusion")] {
            if count > 0 {
                let materials = counted(count, "material has", "materials have");
                notes.push(format!("{materials} textures {what}, which are not drawn"));
            }
        }
        self.textures.looks.finish(mesh, notes)
    }
}

/// The region that the file states in our own way: `"extras": {"region": "eye"}`.
fn stated_region(extras: &Value) -> Option<Region> {
    Some(match extras.get("region")?.as_str()? {
        "skin" => Region::Skin,
        "eye" => Region::Eye,
        "cloth" => Region::Cloth,
        "other" => Region::Other,
        _ => return None,
    })
}
