//! Materials: preview surfaces with their textures, in the package or in the folder of the file.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use glam::{Affine2, Mat2, Vec2, Vec3, Vec4};
use lovelock_usd::{Layer, Value};

use super::{inherited_target, package};
use crate::look::{Encoded, Folder, Known, Looks, named_region};
use crate::surface::CLAY;
use crate::{Alpha, Material, MotionError, TextureUse, Wrap};

/// Most parts with materials of their own of one mesh.
const MOST_PARTS: usize = 250;

/// Usual primvars of the first set of texture coordinates.
pub(super) const FIRST_SET: [&str; 2] = ["st", "UVMap"];

/// Where the images of a stage are.
#[derive(Clone, Copy)]
pub(super) enum Files<'a> {
    /// In the package of these bytes.
    Package(&'a [u8]),
    /// In the folder of the file.
    Folder(Option<&'a Path>),
}

impl Default for Files<'_> {
    fn default() -> Self {
        Self::Folder(None)
    }
}

/// What the vertices of a material take from it.
#[derive(Clone, Copy)]
pub(super) struct Coat {
    pub(super) material: u16,
    /// Its colour, linear sRGB; `None` if that is the display colour of the mesh.
    pub(super) color: Option<Vec3>,
}

/// The materials of the faces of a mesh.
pub(super) struct Parts {
    /// At least one; the first is that of faces without one of their own.
    pub(super) coats: Vec<Coat>,
    of_faces: Vec<u32>,
}

impl Parts {
    /// The number of the coat of a face.
    pub(super) fn of_face(&self, face: usize) -> u32 {
        self.of_faces.get(face).copied().unwrap_or(0)
    }
}

/// The materials of a stage.
#[derive(Default)]
pub(super) struct Materials<'a> {
    files: Files<'a>,
    /// Shaders by their paths, ascending.
    shaders: Vec<(String, usize)>,
    /// The subsets of each mesh.
    subsets: BTreeMap<usize, Vec<usize>>,
    pub(super) looks: Looks<'a>,
    coats: BTreeMap<Option<usize>, Coat>,
    images: BTreeMap<String, usize>,
    folder: Option<Folder<'a>>,
    /// The primvar of the second set of texture coordinates: the first that is not one of the usual ones of the first set.
    pub(super) second_set: Option<String>,
}

impl<'a> Materials<'a> {
    pub(super) fn read(layer: &mut dyn Layer, files: Files<'a>) -> Result<Self, MotionError> {
        let prims = layer.prims(&["Shader"])?;
        let mut shaders: Vec<(String, usize)> =
            prims.into_iter().map(|(prim, _)| (layer.path(prim), prim)).collect();
        shaders.sort();
        let mut subsets: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (prim, _) in layer.prims(&["GeomSubset"])? {
            if let Some(mesh) = layer.parent(prim) {
                subsets.entry(mesh).or_default().push(prim);
            }
        }
        let folder = match files {
            Files::Folder(folder) => Some(Folder::new(folder)),
            Files::Package(_) => None,
        };
        Ok(Self { files, shaders, subsets, folder, ..Self::default() })
    }

    /// The materials of a mesh of so many faces.
    pub(super) fn parts(
        &mut self,
        layer: &mut dyn Layer,
        prim: usize,
        faces: usize,
    ) -> Result<Parts, MotionError> {
        let bound = inherited_target(layer, prim, "material:binding")?;
        let mut coats = vec![self.coat(layer, bound, prim)?];
        let mut of_faces = Vec::new();
        let subsets = self.subsets.get(&prim).cloned().unwrap_or_default();
        for subset in subsets.into_iter().take(MOST_PARTS) {
            let bound = inherited_target(layer, subset, "material:binding")?;
            let kind = layer.attribute(subset, "elementType", 1)?;
            if bound.is_none() || kind.is_some_and(|kind| kind.token().is_some_and(|kind| kind != "face")) {
                continue;
            }
            let indices = layer.attribute(subset, "indices", faces)?.map_or_else(Vec::new, Value::into_ints);
            of_faces.resize(faces, 0);
            for face in indices {
                if let Some(of_face) = usize::try_from(face).ok().and_then(|face| of_faces.get_mut(face)) {
                    *of_face = coats.len() as u32;
                }
            }
            coats.push(self.coat(layer, bound, prim)?);
        }
        Ok(Parts { coats, of_faces })
    }

    fn coat(
        &mut self,
        layer: &mut dyn Layer,
        material: Option<usize>,
        mesh: usize,
    ) -> Result<Coat, MotionError> {
        if let Some(&known) = self.coats.get(&material) {
            return Ok(known);
        }
        let new = match material {
            None => Coat { material: self.looks.add(Material::default(), Known::No), color: None },
            Some(material) => self.material(layer, material, mesh)?,
        };
        self.coats.insert(material, new);
        Ok(new)
    }

    fn material(&mut self, layer: &mut dyn Layer, prim: usize, mesh: usize) -> Result<Coat, MotionError> {
        let path = layer.path(prim);
        let (folder, name) = (format!("{path}/"), path.rsplit('/').next().unwrap_or_default().to_owned());
        let first = self.shaders.partition_point(|(path, _)| *path < folder);
        let below = self.shaders[first..].iter().take_while(|(path, _)| path.starts_with(&folder));
        let below: Vec<usize> = below.map(|(_, shader)| *shader).collect();
        let mesh = layer.path(mesh);
        let mesh_name = mesh.rsplit('/').next().unwrap_or_default();
        let region = named_region(&[&name, mesh_name]);
        let mut material = Material { name: name.chars().take(80).collect(), ..Material::default() };
        let mut color = None;
        let mut painted = None;
        for surface in below {
            let is_surface = token(layer, surface, "info:id")?.as_deref() == Some("UsdPreviewSurface");
            let stated = vector(layer, surface, "inputs:diffuseColor")?;
            if !is_surface && stated.is_none() {
                continue;
            }
            color = stated;
            if let Some((base, factor)) = self.texture(layer, surface, "inputs:diffuseColor")? {
                material.base = Some(base);
                // The stated colour is seen where the image is missing.
                color = Some(stated.unwrap_or(CLAY));
                painted = Some(positive(factor));
            }
            // Values from 0 to 1 become -1 to 1 by a factor of 2, times the slope.
            material.normal = self.texture(layer, surface, "inputs:normal")?.map(|(of, factor)| {
                let slope = 0.5 * factor.x;
                (of, if factor == Vec4::ONE || slope == 0.0 { 1.0 } else { slope })
            });
            let emissive = vector(layer, surface, "inputs:emissiveColor")?.unwrap_or(Vec3::ZERO);
            material.emissive = emissive.max(Vec3::ZERO);
            if let Some((glow, factor)) = self.texture(layer, surface, "inputs:emissiveColor")? {
                material.emissive_texture = Some(glow);
                material.emissive = positive(factor);
            }
            let threshold = number(layer, surface, "inputs:opacityThreshold")?.unwrap_or(0.0);
            if !layer.targets(surface, "inputs:opacity")?.is_empty() && material.base.is_some() {
                material.alpha = if threshold > 0.0 { Alpha::Mask(threshold) } else { Alpha::Blend };
            }
            if let Some(roughness) = number(layer, surface, "inputs:roughness")? {
                material.roughness = roughness.clamp(0.0, 1.0);
            }
            if let Some((rough, factor)) = self.texture(layer, surface, "inputs:roughness")? {
                material.roughness_texture = Some(rough);
                material.roughness = factor.y.clamp(0.0, 1.0);
            }
            break;
        }
        let material = match painted {
            Some(painted) => self.looks.add_painted(material, region, painted),
            None => self.looks.add(material, region),
        };
        Ok(Coat { material, color })
    }

    /// The texture that an input of a surface takes its value from, and the factor of its values (`inputs:scale`).
    fn texture(
        &mut self,
        layer: &mut dyn Layer,
        surface: usize,
        input: &str,
    ) -> Result<Option<(TextureUse, Vec4)>, MotionError> {
        let Some(texture) = source(layer, surface, input)? else { return Ok(None) };
        let Some(file) = token(layer, texture, "inputs:file")?.filter(|file| !file.is_empty()) else {
            return Ok(None);
        };
        let mut transform = Affine2::IDENTITY;
        let mut reader = source(layer, texture, "inputs:st")?;
        if let Some(before) = reader
            && token(layer, before, "info:id")?.as_deref() == Some("UsdTransform2d")
        {
            let turn = number(layer, before, "inputs:rotation")?.unwrap_or(0.0).to_radians();
            let size = pair(layer, before, "inputs:scale")?.unwrap_or(Vec2::ONE);
            let offset = pair(layer, before, "inputs:translation")?.unwrap_or(Vec2::ZERO);
            let flip = Affine2 { matrix2: Mat2::from_diagonal(Vec2::new(1.0, -1.0)), translation: Vec2::Y };
            let placed = flip * Affine2::from_scale_angle_translation(size, turn, offset) * flip;
            if TextureUse::can_place(&placed) {
                transform = placed;
            }
            reader = source(layer, before, "inputs:in")?;
        }
        let primvar = match reader {
            Some(reader) => token(layer, reader, "inputs:varname")?,
            None => None,
        };
        let Some(set) = self.set_of(primvar) else {
            self.looks.leave_out_set();
            return Ok(None);
        };
        let factor = layer.attribute(texture, "inputs:scale", 1)?.map_or_else(Vec::new, Value::into_floats);
        let factor = factor.first_chunk().map_or(Vec4::ONE, |factor: &[f32; 4]| Vec4::from(*factor));
        let factor = if factor.is_finite() { factor } else { Vec4::ONE };
        let mut wrap = [Wrap::Repeat; 2];
        for (wrap, input) in wrap.iter_mut().zip(["inputs:wrapS", "inputs:wrapT"]) {
            *wrap = match token(layer, texture, input)?.as_deref() {
                Some("clamp" | "black") => Wrap::Clamp,
                Some("mirror") => Wrap::Mirror,
                _ => Wrap::Repeat,
            };
        }
        let image = self.image(&file);
        Ok(Some((TextureUse { image, set, transform, wrap, is_nearest: false }, factor)))
    }

    /// The set of texture coordinates of a primvar; `None` beyond the second.
    fn set_of(&mut self, primvar: Option<String>) -> Option<usize> {
        let Some(name) = primvar.filter(|name| !FIRST_SET.contains(&name.as_str()) && !name.is_empty())
        else {
            return Some(0);
        };
        (*self.second_set.get_or_insert_with(|| name.clone()) == name).then_some(1)
    }

    fn image(&mut self, file: &str) -> usize {
        if let Some(&known) = self.images.get(file) {
            return known;
        }
        let name: String = file.rsplit(['/', '\\']).next().unwrap_or(file).chars().take(80).collect();
        let looks = &mut self.looks;
        let new = match (self.files, &mut self.folder) {
            (Files::Package(bytes), _) => {
                let bytes = package::entry(bytes, file).map(Cow::Borrowed);
                looks.add_image(Encoded {
                    name,
                    bytes: bytes.ok_or_else(|| "is not in the package".to_owned()),
                })
            }
            (Files::Folder(_), Some(folder)) => {
                folder.image(&[file], |bytes| looks.add_image(Encoded { name, bytes: bytes.map(Cow::Owned) }))
            }
            (Files::Folder(_), None) => {
                looks.add_image(Encoded { name, bytes: Err("is outside of the file".to_owned()) })
            }
        };
        self.images.insert(file.to_owned(), new);
        new
    }
}

/// Red, green and blue of a factor, each 0 or more.
fn positive(factor: Vec4) -> Vec3 {
    factor.truncate().max(Vec3::ZERO)
}

/// The shader from which an input takes its value.
fn source(layer: &mut dyn Layer, shader: usize, input: &str) -> Result<Option<usize>, MotionError> {
    let targets = layer.targets(shader, input)?;
    let Some(target) = targets.first() else { return Ok(None) };
    // The path of an output: its name stands after a dot, in crates after a slash.
    let end = target.rfind(".outputs:").or_else(|| target.rfind("/outputs:")).unwrap_or(target.len());
    Ok(layer.prim_at(&target[..end]))
}

fn token(layer: &mut dyn Layer, prim: usize, name: &str) -> Result<Option<String>, MotionError> {
    Ok(layer.attribute(prim, name, 1)?.and_then(|value| value.token().map(str::to_owned)))
}

fn number(layer: &mut dyn Layer, prim: usize, name: &str) -> Result<Option<f32>, MotionError> {
    let value = layer.attribute(prim, name, 1)?.and_then(|value| value.into_floats().first().copied());
    Ok(value.filter(|number| number.is_finite()))
}

fn vector(layer: &mut dyn Layer, prim: usize, name: &str) -> Result<Option<Vec3>, MotionError> {
    let value = layer.attribute(prim, name, 1)?.and_then(|value| value.into_vectors().first().copied());
    Ok(value.filter(|vector| vector.is_finite()))
}

fn pair(layer: &mut dyn Layer, prim: usize, name: &str) -> Result<Option<Vec2>, MotionError> {
    let value = layer.attribute(prim, name, 1)?.map(Value::into_floats);
    Ok(value.and_then(|pair| Some(Vec2::new(*pair.first()?, *pair.get(1)?))).filter(|pair| pair.is_finite()))
}
