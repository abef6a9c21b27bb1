//! Materials, textures and images of the exported body in glTF.

use std::io;

use glam::{Affine2, Vec3};
use lovelock_gltf::glb::Buffer;
use lovelock_motion::{Alpha, Material, Region, TextureUse, Wrap};
use serde_json::{Value, json};

use super::CurveBody;
use super::look::{is_unlit, png, textures_of};

/// What a document has for the look of the body.
#[derive(Debug, Default)]
pub(super) struct GltfLook {
    pub(super) materials: Vec<Value>,
    pub(super) textures: Vec<Value>,
    pub(super) samplers: Vec<Value>,
    pub(super) images: Vec<Value>,
    /// Extensions that they use.
    pub(super) extensions: Vec<&'static str>,
    /// The texture of each use of an image with a sampler.
    known: Vec<(usize, usize)>,
}

impl GltfLook {
    /// Writes the images of a body into a buffer, and its materials.
    pub(super) fn new(body: &CurveBody, buffer: &mut Buffer) -> io::Result<Self> {
        let mut look = Self::default();
        let mut place = vec![None; body.images.len()];
        for of in body.materials.iter().flat_map(textures_of) {
            if place[of.image].is_none() {
                let image = &body.images[of.image];
                let view = buffer.add_bytes(&png(image)?);
                place[of.image] = Some(look.images.len());
                look.images.push(json!({ "name": image.name, "mimeType": "image/png", "bufferView": view }));
            }
        }
        let place: Vec<usize> = place.into_iter().map(Option::unwrap_or_default).collect();
        for material in &body.materials {
            let written = look.material(material, &place);
            look.materials.push(written);
        }
        Ok(look)
    }

    fn material(&mut self, material: &Material, place: &[usize]) -> Value {
        let mut written = json!({
            "name": material.name,
            "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": material.roughness },
            "extras": { "region": region(material.region) },
        });
        if let Some(base) = material.base {
            written["pbrMetallicRoughness"]["baseColorTexture"] = self.texture(base, place);
        }
        if let Some(rough) = material.roughness_texture {
            written["pbrMetallicRoughness"]["metallicRoughnessTexture"] = self.texture(rough, place);
        }
        if let Some((normal, slope)) = material.normal {
            let mut texture = self.texture(normal, place);
            texture["scale"] = slope.into();
            written["normalTexture"] = texture;
        }
        if material.emissive != Vec3::ZERO {
            let strength = material.emissive.max_element().max(1.0);
            written["emissiveFactor"] = json!((material.emissive / strength).to_array());
            if strength > 1.0 {
                let extension = self.extension("KHR_materials_emissive_strength");
                written["extensions"][extension] = json!({ "emissiveStrength": strength });
            }
            if let Some(texture) = material.emissive_texture {
                written["emissiveTexture"] = self.texture(texture, place);
            }
        }
        match material.alpha {
            Alpha::Opaque => {}
            Alpha::Mask(cutoff) => {
                written["alphaMode"] = "MASK".into();
                written["alphaCutoff"] = cutoff.into();
            }
            Alpha::Blend => written["alphaMode"] = "BLEND".into(),
        }
        if material.is_double_sided {
            written["doubleSided"] = true.into();
        }
        if is_unlit(material) {
            written["extensions"]["KHR_materials_unlit"] = json!({});
        }
        written
    }

    fn texture(&mut self, of: TextureUse, place: &[usize]) -> Value {
        let wrap = of.wrap.map(|wrap| match wrap {
            Wrap::Repeat => 10497,
            Wrap::Mirror => 33648,
            Wrap::Clamp => 33071,
        });
        let [magnified, reduced] = if of.is_nearest { [9728, 9984] } else { [9729, 9987] };
        let sampler =
            json!({ "wrapS": wrap[0], "wrapT": wrap[1], "magFilter": magnified, "minFilter": reduced });
        let sampler = position_or_push(&mut self.samplers, sampler);
        let texture = (place[of.image], sampler);
        let index = self.known.iter().position(|known| *known == texture).unwrap_or_else(|| {
            self.known.push(texture);
            self.textures.push(json!({ "source": texture.0, "sampler": texture.1 }));
            self.textures.len() - 1
        });
        let mut written = json!({ "index": index, "texCoord": of.set });
        if of.transform != Affine2::IDENTITY {
            let (scale, angle, offset) = of.transform.to_scale_angle_translation();
            let extension = self.extension("KHR_texture_transform");
            written["extensions"][extension] =
                json!({ "offset": offset.to_array(), "rotation": -angle, "scale": scale.to_array() });
        }
        written
    }

    /// Remembers that an extension is used.
    fn extension(&mut self, name: &'static str) -> &'static str {
        if !self.extensions.contains(&name) {
            self.extensions.push(name);
        }
        name
    }
}

fn position_or_push(list: &mut Vec<Value>, value: Value) -> usize {
    list.iter().position(|known| *known == value).unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}

fn region(region: Region) -> &'static str {
    match region {
        Region::Skin => "skin",
        Region::Eye => "eye",
        Region::Cloth => "cloth",
        Region::Other => "other",
    }
}
