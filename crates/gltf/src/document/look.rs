//! Materials, textures, samplers and images.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer};
use serde_json::Value;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Material {
    #[serde(deserialize_with = "lenient")]
    pub name: Option<String>,
    #[serde(deserialize_with = "lenient")]
    pub pbr_metallic_roughness: Pbr,
    #[serde(deserialize_with = "lenient")]
    pub normal_texture: Option<TextureInfo>,
    #[serde(deserialize_with = "lenient")]
    pub occlusion_texture: Option<TextureInfo>,
    #[serde(deserialize_with = "lenient")]
    pub emissive_factor: Option<[f32; 3]>,
    #[serde(deserialize_with = "lenient")]
    pub emissive_texture: Option<TextureInfo>,
    #[serde(deserialize_with = "lenient")]
    pub alpha_mode: Option<String>,
    #[serde(deserialize_with = "lenient")]
    pub alpha_cutoff: Option<f32>,
    #[serde(deserialize_with = "lenient")]
    pub double_sided: bool,
    pub extensions: Value,
    pub extras: Value,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Pbr {
    #[serde(deserialize_with = "lenient")]
    pub base_color_factor: Option<[f32; 4]>,
    #[serde(deserialize_with = "lenient")]
    pub base_color_texture: Option<TextureInfo>,
    #[serde(deserialize_with = "lenient")]
    pub roughness_factor: Option<f32>,
    #[serde(deserialize_with = "lenient")]
    pub metallic_roughness_texture: Option<TextureInfo>,
    #[serde(deserialize_with = "lenient")]
    pub metallic_factor: Option<f32>,
}

/// A texture as a material uses it.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct TextureInfo {
    pub index: usize,
    #[serde(default, deserialize_with = "lenient")]
    pub tex_coord: usize,
    /// Of a texture of normals.
    #[serde(default, deserialize_with = "lenient")]
    pub scale: Option<f32>,
    #[serde(default)]
    pub extensions: Value,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Texture {
    #[serde(deserialize_with = "lenient")]
    pub source: Option<usize>,
    #[serde(deserialize_with = "lenient")]
    pub sampler: Option<usize>,
    #[serde(deserialize_with = "lenient")]
    pub extensions: BTreeMap<String, Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Sampler {
    #[serde(deserialize_with = "lenient")]
    pub wrap_s: Option<u32>,
    #[serde(deserialize_with = "lenient")]
    pub wrap_t: Option<u32>,
    #[serde(deserialize_with = "lenient")]
    pub mag_filter: Option<u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Image {
    #[serde(deserialize_with = "lenient")]
    pub name: Option<String>,
    #[serde(deserialize_with = "lenient")]
    pub uri: Option<String>,
    #[serde(deserialize_with = "lenient")]
    pub buffer_view: Option<usize>,
}

/// A value, or the default if the file has something else there.
fn lenient<'de, D: Deserializer<'de>, T: DeserializeOwned + Default>(deserializer: D) -> Result<T, D::Error> {
    Ok(T::deserialize(Value::deserialize(deserializer)?).unwrap_or_default())
}

/// A list in which elements of another kind are the default, so that the others keep their numbers; empty if it is no list.
pub(super) fn lenient_list<'de, D: Deserializer<'de>, T: DeserializeOwned + Default>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    let Value::Array(elements) = Value::deserialize(deserializer)? else { return Ok(Vec::new()) };
    Ok(elements.into_iter().map(|element| T::deserialize(element).unwrap_or_default()).collect())
}

#[cfg(test)]
mod tests {
    use crate::Document;

    #[test]
    fn what_is_wrong_in_a_material_is_as_if_it_were_not_there() {
        let document: Document = serde_json::from_str(
            r#"{"materials":[{"name":7,"doubleSided":true,"alphaCutoff":"x","pbrMetallicRoughness":{"baseColorTexture":{"index":1},
            "baseColorFactor":[1,2]}},[],{"name":"b","normalTexture":{"index":-1},"extensions":4}],"textures":4,"images":[{"uri":3},{"uri":"a"}]}"#,
        )
        .unwrap();
        let [first, second, third] = &document.materials[..] else { panic!("three materials") };
        assert_eq!((first.name.as_deref(), first.double_sided, first.alpha_cutoff), (None, true, None));
        assert_eq!(first.pbr_metallic_roughness.base_color_texture.as_ref().unwrap().index, 1);
        assert_eq!(first.pbr_metallic_roughness.base_color_factor, None);
        assert!(!second.double_sided);
        assert_eq!((third.name.as_deref(), third.normal_texture.is_none()), (Some("b"), true));
        assert!(document.textures.is_empty());
        assert_eq!(
            document.images.iter().map(|image| image.uri.as_deref()).collect::<Vec<_>>(),
            [None, Some("a")]
        );
    }
}
