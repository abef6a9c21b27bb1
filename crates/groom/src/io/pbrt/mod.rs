//! Curves of pbrt scenes, versions 3 and 4: every `Shape "curve"` in world space, read as a stream.
//!
//! The transforms in scope apply. `Include` and `Import` are followed into the folder of the file and below.
//! `ObjectInstance` repeats the curves of an object. Everything else in a scene is skipped.

mod curve;
mod scene;
mod tokens;
mod write;

use super::HairFileError;
use super::file::RawHair;
use super::format::HairFormat;
use super::source::Source;
use super::units::UpAxis;
use super::words::begins_with_word;
use scene::Scene;

pub(super) static FORMAT: HairFormat = HairFormat {
    label: "pbrt curves",
    extensions: &["pbrt", "gz"],
    signature: "a directive of pbrt such as `Shape`",
    states_unit: false,
    common_up: UpAxis::Y,
    magics: &[tokens::GZIP],
    may_begin: |start| begins_with_word(start, &DIRECTIVES),
    by_chance: false,
    read,
    write: Some(write::write),
};

/// Directives with which a file may begin.
const DIRECTIVES: [&str; 39] = [
    "ActiveTransform",
    "AreaLightSource",
    "CoordSysTransform",
    "CoordinateSystem",
    "ObjectInstance",
    "Shape",
    "AttributeBegin",
    "TransformBegin",
    "ObjectBegin",
    "WorldBegin",
    "LookAt",
    "Camera",
    "Film",
    "Sampler",
    "Integrator",
    "SurfaceIntegrator",
    "VolumeIntegrator",
    "Renderer",
    "PixelFilter",
    "Accelerator",
    "Option",
    "ColorSpace",
    "Include",
    "Import",
    "Material",
    "MakeNamedMaterial",
    "NamedMaterial",
    "MakeNamedMedium",
    "MediumInterface",
    "Texture",
    "Translate",
    "Scale",
    "Rotate",
    "Transform",
    "ConcatTransform",
    "Identity",
    "Attribute",
    "LightSource",
    "ReverseOrientation",
];

fn read(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let folder = source.folder();
    Scene::new(name, folder).read(source.into_reader())
}

#[cfg(test)]
mod tests;
