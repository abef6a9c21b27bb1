//! `cargo xtask assets`: makes the dancer, `assets/dancer.glb`, and the bodies of fur and grass, `animal.glb` and `lawn.glb`.
//!
//! Every figure is one signed distance function ([`figure`], [`head`]; [`animal`]; [`lawn`]), meshed by surface nets ([`mesh`]), remeshed with regular
//! triangles ([`remesh`]). The dancer is coloured ([`paint`]), bound to a skeleton ([`rig`], [`weights`]) and animated by a score of
//! key poses ([`score`], [`dance`]). The same source gives the same bytes.

mod animal;
mod dance;
mod figure;
mod glb;
mod head;
mod ik;
mod lawn;
mod mesh;
mod paint;
mod pictures;
mod preview;
mod remesh;
mod rig;
mod score;
mod sdf;
mod weights;

#[cfg(test)]
mod tests;

use lovelock_base::numbers::smoothstep;
use std::path::{Path, PathBuf};

use anyhow::Context;
use glam::Vec3;
use rayon::prelude::*;

/// Half of the width over which the scalp mask goes from 0 to 1, in metres.
const HAIRLINE_HALF_WIDTH: f32 = 0.004;

/// Generates all shipped assets; with a preview folder, also writes images of the figure there.
pub(crate) fn run(preview: Option<&Path>) -> anyhow::Result<()> {
    let dancer = make();
    for model in [&dancer, &animal::make(), &lawn::make()] {
        save(model)?;
    }
    if let Some(folder) = preview {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        pictures::write(&dancer, folder)?;
    }
    Ok(())
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
        model.positions.len(),
        model.triangles.len(),
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
    glb::Model {
        name,
        normals: mesh::normals(distance, &net.positions),
        colours: net.positions.iter().map(|p| colour(*p)).collect(),
        scalp: net.positions.iter().map(|p| scalp(*p)).collect(),
        influences: vec![[(0, u16::MAX), (0, 0), (0, 0), (0, 0)]; net.positions.len()],
        joints: vec![rig::RigJoint { name: name.to_owned(), parent: None, rest: origin }],
        clips: Vec::new(),
        positions: net.positions,
        triangles: net.triangles,
    }
}

/// Builds the dancer from its parts.
fn make() -> glb::Model {
    let figure = figure::Figure::new();
    let distance = |p: Vec3| figure.distance(p);
    let mut net = mesh::surface_nets(&mesh::Grid::dancer(), &distance);
    net.positions.par_iter_mut().for_each(|p| *p = mesh::project(&distance, *p));
    remesh::remesh(&mut net, &distance, &figure::edge_length, 6);
    remesh::snap(&mut net, &distance, &paint::seam, &figure::edge_length);
    let joints = rig::joints();
    let influences = weights::influences(&net, joints.len());
    let clips = [score::dance(), score::idle()].iter().map(|score| score.sample(&joints)).collect();
    glb::Model {
        name: "dancer",
        normals: mesh::normals(&distance, &net.positions),
        colours: net.positions.iter().map(|p| paint::colour(*p)).collect(),
        scalp: net.positions.iter().map(|p| scalp(*p)).collect(),
        influences,
        joints,
        clips,
        positions: net.positions,
        triangles: net.triangles,
    }
}

/// 1 where hair grows, 0 elsewhere.
fn scalp(p: Vec3) -> f32 {
    if p.y < head::CHIN_Y {
        return 0.0;
    }
    smoothstep(-HAIRLINE_HALF_WIDTH, HAIRLINE_HALF_WIDTH, head::inside_hairline(p))
}
