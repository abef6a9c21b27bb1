//! `cargo xtask assets`: makes the dancer, `assets/dancer.glb`.
//!
//! The figure is one signed distance function ([`figure`], [`head`]), meshed by surface nets ([`mesh`]), remeshed with regular
//! triangles ([`remesh`]), coloured ([`paint`]), bound to a skeleton ([`rig`], [`weights`]) and animated by a score of key
//! poses ([`score`], [`dance`]). The same source gives the same bytes.

mod dance;
mod figure;
mod glb;
mod head;
mod ik;
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
    let bytes = glb::write(&dancer)?;
    let path = path();
    // Written under a temporary name first, so that a full disk does not destroy the old file.
    let beside = path.with_extension("glb.new");
    std::fs::write(&beside, &bytes).with_context(|| format!("cannot write {}", beside.display()))?;
    std::fs::rename(&beside, &path).with_context(|| format!("cannot replace {}", path.display()))?;
    println!(
        "{}: {} vertices, {} triangles, {} joints, {} bytes",
        path.display(),
        dancer.positions.len(),
        dancer.triangles.len(),
        dancer.joints.len(),
        bytes.len()
    );
    if let Some(folder) = preview {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        pictures::write(&dancer, folder)?;
    }
    Ok(())
}

/// Path of the dancer.
fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb")
}

/// Builds the dancer from its parts.
fn make() -> glb::Dancer {
    let figure = figure::Figure::new();
    let distance = |p: Vec3| figure.distance(p);
    let mut net = mesh::surface_nets(&distance);
    net.positions.par_iter_mut().for_each(|p| *p = mesh::project(&distance, *p));
    remesh::remesh(&mut net, &distance, &figure::edge_length, 6);
    remesh::snap(&mut net, &distance, &paint::seam, &figure::edge_length);
    let joints = rig::joints();
    let influences = weights::influences(&net, joints.len());
    let clips = [score::dance(), score::idle()].iter().map(|score| score.sample(&joints)).collect();
    glb::Dancer {
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
