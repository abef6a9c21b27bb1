//! Materials of the exported body in USD: preview surfaces, and their images as PNG files in a folder beside the file.

use std::io::{self, Write as _};
use std::path::Path;

use glam::{Affine2, Vec2, Vec3};
use lovelock_motion::{Alpha, Material, TextureUse, Wrap};
use openusd::gf::{Vec2f, Vec3f, Vec4f};
use openusd::sdf::{self, AssetPath, Value};
use openusd::tf::Token;

use super::CurveBody;
use super::layer::{PrimBuilder, SpooledLayer, child, uniform};
use super::look::{is_unlit, png, textures_of};
use crate::partial::{PartialFile, open_file};

/// The names of a set of texture coordinates.
pub(super) struct Coordinates {
    /// Of the attribute of the mesh.
    pub(super) primvar: &'static str,
    /// Of the primvar as shaders read it.
    name: &'static str,
    /// Of the shader that reads it.
    reader: &'static str,
}

/// The names of both sets.
pub(super) const COORDINATES: [Coordinates; 2] = [
    Coordinates { primvar: "primvars:st", name: "st", reader: "St" },
    Coordinates { primvar: "primvars:st1", name: "st1", reader: "St1" },
];

/// The name of the folder for images beside a file.
pub(super) fn folder_of(target: &Path) -> String {
    format!("{}_textures", target.file_stem().unwrap_or_default().to_string_lossy())
}

fn file_of(image: usize) -> String {
    format!("image_{image}.png")
}

/// The path of a material in the scope of materials.
pub(super) fn path_of(scope: &sdf::Path, material: usize) -> sdf::Path {
    child(scope, &format!("Material_{material}"))
}

/// Writes the images that materials use into the folder beside the file.
pub(super) fn write_images(target: &Path, folder: &str, body: &CurveBody) -> io::Result<()> {
    let mut used: Vec<usize> = body.materials.iter().flat_map(textures_of).map(|of| of.image).collect();
    used.sort_unstable();
    used.dedup();
    if used.is_empty() || body.of_triangles.is_empty() {
        return Ok(());
    }
    let folder = target.with_file_name(folder);
    std::fs::create_dir_all(&folder)?;
    for image in used {
        let mut file = PartialFile::create(&folder.join(file_of(image)), &open_file)?;
        file.write_all(&png(&body.images[image])?)?;
        file.commit(true)?;
    }
    Ok(())
}

/// Adds the scope of materials.
pub(super) fn materials(layer: &mut SpooledLayer, scope: &sdf::Path, body: &CurveBody, textures: &str) {
    let parts = body.parts();
    let mut names = Vec::new();
    for (index, triangles) in parts.iter().filter_map(|(index, triangles)| Some(((*index)?, triangles))) {
        let path = path_of(scope, index);
        names.push(Token::from(format!("Material_{index}").as_str()));
        let writer = Writer { layer: &mut *layer, path, textures, children: Vec::new() };
        writer.material(&body.materials[index], body.mean_color(triangles));
    }
    layer.prim(scope.clone(), "Scope").finish(names);
}

/// Writes one material.
struct Writer<'a> {
    layer: &'a mut SpooledLayer,
    path: sdf::Path,
    textures: &'a str,
    children: Vec<Token>,
}

impl Writer<'_> {
    /// A preview surface. A texture is multiplied by the mean colour of the vertices, for which preview surfaces have no other place.
    fn material(mut self, material: &Material, mean: Vec3) {
        let base =
            material.base.map(|of| self.texture("Base", of, "auto", mean.extend(1.0).to_array(), [0.0; 4]));
        let normal = material.normal.map(|(of, slope)| {
            let scale = [2.0 * slope, 2.0 * slope, 2.0, 1.0];
            self.texture("Normal", of, "raw", scale, [-slope, -slope, -1.0, 0.0])
        });
        let emissive = material.emissive_texture.map(|of| {
            self.texture("Emissive", of, "auto", material.emissive.extend(1.0).to_array(), [0.0; 4])
        });
        // Only green is read.
        let rough = material
            .roughness_texture
            .map(|of| self.texture("Roughness", of, "raw", [material.roughness; 4], [0.0; 4]));
        let vertex_colors = base.is_none().then(|| self.vertex_colors());
        let surface = self.child("Surface");
        let mut shader = self.shader(&surface, "UsdPreviewSurface");
        let output = |of: &sdf::Path, name: &str| of.append_property(name).unwrap_or_else(|_| of.clone());
        let unlit = is_unlit(material);
        if unlit {
            shader
                .attribute("inputs:diffuseColor", "color3f")
                .add("default", Value::Vec3f(Vec3f::from([0.0; 3])));
        }
        let seen = if unlit { "inputs:emissiveColor" } else { "inputs:diffuseColor" };
        match (&base, &vertex_colors) {
            (Some(base), _) => shader.connection(seen, "color3f", output(base, "outputs:rgb")),
            (None, Some(colors)) => shader.connection(seen, "color3f", output(colors, "outputs:result")),
            (None, None) => {}
        }
        if material.alpha != Alpha::Opaque
            && let Some(base) = &base
        {
            shader.connection("inputs:opacity", "float", output(base, "outputs:a"));
        }
        if let Alpha::Mask(cutoff) = material.alpha {
            shader.attribute("inputs:opacityThreshold", "float").add("default", Value::Float(cutoff));
        }
        if let Some(normal) = &normal {
            shader.connection("inputs:normal", "normal3f", output(normal, "outputs:rgb"));
        }
        match &emissive {
            _ if unlit => {}
            Some(emissive) => {
                shader.connection("inputs:emissiveColor", "color3f", output(emissive, "outputs:rgb"));
            }
            None if material.emissive != Vec3::ZERO => {
                let light = Value::Vec3f(Vec3f::from(material.emissive.to_array()));
                shader.attribute("inputs:emissiveColor", "color3f").add("default", light);
            }
            None => {}
        }
        if let Some(rough) = &rough {
            shader.connection("inputs:roughness", "float", output(rough, "outputs:g"));
        } else {
            shader.attribute("inputs:roughness", "float").add("default", Value::Float(material.roughness));
        }
        shader.attribute("inputs:metallic", "float").add("default", Value::Float(0.0));
        shader.attribute("outputs:surface", "token");
        shader.finish(Vec::new());
        let (path, children) = (self.path.clone(), std::mem::take(&mut self.children));
        let mut prim = self.layer.prim(path, "Material");
        prim.connection("outputs:surface", "token", output(&surface, "outputs:surface"));
        prim.finish(children);
    }

    /// A texture with the readers that it needs. Colours are multiplied by `scale`, then `bias` is added.
    fn texture(
        &mut self,
        name: &'static str,
        of: TextureUse,
        space: &'static str,
        scale: [f32; 4],
        bias: [f32; 4],
    ) -> sdf::Path {
        let names = &COORDINATES[of.set.min(1)];
        let mut coordinates = self.reader(names.reader, names.name, "UsdPrimvarReader_float2", "float2");
        if of.transform != Affine2::IDENTITY {
            let path = self.child(match name {
                "Base" => "BaseTransform",
                "Normal" => "NormalTransform",
                "Roughness" => "RoughnessTransform",
                _ => "EmissiveTransform",
            });
            // Texture coordinates of USD count from below, before and after.
            let flip =
                Affine2 { matrix2: glam::Mat2::from_diagonal(Vec2::new(1.0, -1.0)), translation: Vec2::Y };
            let (size, angle, offset) = (flip * of.transform * flip).to_scale_angle_translation();
            let mut shader = self.shader(&path, "UsdTransform2d");
            shader.connection("inputs:in", "float2", coordinates);
            shader.attribute("inputs:rotation", "float").add("default", Value::Float(angle.to_degrees()));
            for (name, pair) in [("inputs:scale", size), ("inputs:translation", offset)] {
                shader.attribute(name, "float2").add("default", Value::Vec2f(Vec2f::from(pair.to_array())));
            }
            shader.attribute("outputs:result", "float2");
            shader.finish(Vec::new());
            coordinates = path.append_property("outputs:result").unwrap_or(path);
        }
        let path = self.child(name);
        let file = format!("./{}/{}", self.textures, file_of(of.image));
        let mut shader = self.shader(&path, "UsdUVTexture");
        shader.attribute("inputs:file", "asset").add("default", Value::AssetPath(AssetPath::new(file)));
        shader.connection("inputs:st", "float2", coordinates);
        for (name, wrap) in [("inputs:wrapS", of.wrap[0]), ("inputs:wrapT", of.wrap[1])] {
            let wrap = match wrap {
                Wrap::Repeat => "repeat",
                Wrap::Mirror => "mirror",
                Wrap::Clamp => "clamp",
            };
            shader.attribute(name, "token").add("default", Value::Token(Token::from(wrap)));
        }
        shader.attribute("inputs:sourceColorSpace", "token").add("default", Value::Token(Token::from(space)));
        shader.attribute("inputs:scale", "float4").add("default", Value::Vec4f(Vec4f::from(scale)));
        shader.attribute("inputs:bias", "float4").add("default", Value::Vec4f(Vec4f::from(bias)));
        shader.attribute("outputs:rgb", "float3");
        shader.attribute("outputs:g", "float");
        shader.attribute("outputs:a", "float");
        shader.finish(Vec::new());
        path
    }

    /// The shader that reads the colours of vertices.
    fn vertex_colors(&mut self) -> sdf::Path {
        self.reader("Colors", "displayColor", "UsdPrimvarReader_float3", "float3");
        child(&self.path, "Colors")
    }

    /// A shader that reads a primvar. Returns its output.
    fn reader(
        &mut self,
        name: &'static str,
        primvar: &'static str,
        id: &'static str,
        type_name: &'static str,
    ) -> sdf::Path {
        let path = child(&self.path, name);
        if !self.children.contains(&Token::from(name)) {
            self.children.push(Token::from(name));
            let mut shader = self.shader(&path, id);
            shader.attribute("inputs:varname", "string").add("default", Value::String(primvar.to_owned()));
            shader.attribute("outputs:result", type_name);
            shader.finish(Vec::new());
        }
        path.append_property("outputs:result").unwrap_or(path)
    }

    fn child(&mut self, name: &'static str) -> sdf::Path {
        self.children.push(Token::from(name));
        child(&self.path, name)
    }

    fn shader(&mut self, path: &sdf::Path, id: &'static str) -> PrimBuilder<'_> {
        let mut shader = self.layer.prim(path.clone(), "Shader");
        uniform(shader.attribute("info:id", "token"), id);
        shader
    }
}
