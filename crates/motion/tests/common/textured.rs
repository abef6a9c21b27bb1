//! A small textured figure: two triangles with a material each, the first of them with every kind of texture.

use std::fmt::Write as _;
use std::io::Cursor;

use image::{ImageFormat, Rgba, RgbaImage};

/// A small image of four colours as PNG, or as JPEG, which has no opacity.
pub fn picture(format: ImageFormat) -> Vec<u8> {
    let image = RgbaImage::from_fn(4, 4, |x, y| {
        Rgba([if x < 2 { 250 } else { 10 }, 60 * y as u8, 30, 255 - 10 * x as u8])
    });
    let mut bytes = Vec::new();
    let written = match format {
        ImageFormat::Jpeg => {
            image::DynamicImage::from(image).to_rgb8().write_to(&mut Cursor::new(&mut bytes), format)
        }
        _ => image.write_to(&mut Cursor::new(&mut bytes), format),
    };
    written.expect("an image");
    bytes
}

/// What a file of [`glb`] has.
pub struct Parts {
    /// `materials` of the document.
    pub materials: String,
    /// Further members of the document, each after a comma.
    pub more: String,
    /// The images: of views 1, 2, … in this order.
    pub images: Vec<Vec<u8>>,
    /// Texture coordinates of the six vertices.
    pub coordinates: [f32; 12],
}

impl Default for Parts {
    fn default() -> Self {
        Self {
            materials: r#"[{"name":"Face","pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1,"extensions":
                {"KHR_texture_transform":{"offset":[0.5,0],"scale":[2,1]}}},"baseColorFactor":[0.5,1,1,0.5],"roughnessFactor":0.25,"metallicFactor":0,"metallicRoughnessTexture":{"index":1}},
                "normalTexture":{"index":1,"scale":0.5},"emissiveFactor":[1,0,0],"emissiveTexture":{"index":0},
                "alphaMode":"MASK","alphaCutoff":0.25,"doubleSided":true},
                {"name":"x","extensions":{"KHR_materials_unlit":{}},"extras":{"region":"cloth"},"alphaMode":"BLEND"}]"#
                .to_owned(),
            more: String::new(),
            images: vec![picture(ImageFormat::Png), picture(ImageFormat::Jpeg)],
            coordinates: std::array::from_fn(|k| k as f32 / 8.0),
        }
    }
}

/// The file. Texture 0 is the first image with a sampler that mirrors and clamps, and texture 1 the second one.
pub fn glb(parts: &Parts) -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let mut floats = |values: &[f32]| bin.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    floats(&[0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0]);
    floats(&parts.coordinates);
    floats(&[1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0, 0.0]);
    floats(&[1.0, 0.5, 0.25]);
    let data = bin.len();
    let mut views = format!(r#"{{"buffer":0,"byteLength":{data}}}"#);
    let mut images = Vec::new();
    for (index, image) in parts.images.iter().enumerate() {
        bin.resize(bin.len().next_multiple_of(4), 0);
        let _ = write!(views, r#",{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#, bin.len(), image.len());
        images.push(format!(
            r#"{{"mimeType":"image/gif","name":"picture {index}","bufferView":{}}}"#,
            index + 1
        ));
        bin.extend(image);
    }
    let accessor = |offset: usize, count: usize, kind: &str| {
        format!(
            r#"{{"bufferView":0,"byteOffset":{offset},"componentType":5126,"count":{count},"type":"{kind}"}}"#
        )
    };
    let accessors = [
        accessor(0, 3, "VEC3"),
        accessor(36, 3, "VEC3"),
        accessor(72, 3, "VEC2"),
        accessor(96, 3, "VEC2"),
        accessor(120, 3, "VEC4"),
        accessor(168, 3, "SCALAR"),
    ];
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"name":"n","mesh":0}}],
        "meshes":[{{"name":"m","primitives":[
        {{"attributes":{{"POSITION":0,"TEXCOORD_0":2,"TEXCOORD_1":3,"COLOR_0":4,"_OCCLUSION":5}},"material":0}},
        {{"attributes":{{"POSITION":1}},"material":1}}]}}],
        "materials":{},"textures":[{{"source":0,"sampler":0}},{{"source":1}}],
        "samplers":[{{"wrapS":33648,"wrapT":33071,"magFilter":9728}}],"images":[{}],
        "accessors":[{}],"bufferViews":[{views}],"buffers":[{{"byteLength":{}}}]{}}}"#,
        parts.materials,
        images.join(","),
        accessors.join(","),
        bin.len(),
        parts.more,
    );
    super::glb(json, bin)
}
