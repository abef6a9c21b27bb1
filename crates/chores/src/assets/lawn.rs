//! A piece of ground for grass: a slab 1.6 m wide with a gently waving upper side.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;

use super::glb::Model;
use super::mesh::{Grid, project, surface_nets};
use super::remesh::remesh;
use super::rigid;
use super::sdf::smax;

/// Half of its width, and its mean height, metres.
const HALF: f32 = 0.8;
const HEIGHT: f32 = 0.06;

/// Earth, linear sRGB.
const EARTH: Vec3 = Vec3::new(0.060, 0.042, 0.028);

/// Builds it.
pub(super) fn make() -> Model {
    let margin = Vec3::new(0.06, 0.06, 0.06);
    let low = Vec3::new(-HALF, 0.0, -HALF);
    let grid = Grid::even(low - margin, Vec3::new(HALF, HEIGHT + 0.05, HALF) + margin, 0.03);
    let mut net = surface_nets(&grid, &distance);
    net.positions.iter_mut().for_each(|p| *p = project(&distance, *p));
    remesh(&mut net, &distance, &|_| 0.04, 4);
    rigid("lawn", net, &distance, (&|_| EARTH, &scalp), Vec3::new(0.0, HEIGHT, 0.0))
}

/// Height of the upper side above y = 0.
fn height(p: Vec3) -> f32 {
    HEIGHT + 0.018 * (3.1 * p.x + 0.6).sin() * (2.3 * p.z).cos() + 0.010 * (5.7 * p.z - 3.9 * p.x).sin()
}

/// Signed distance of its surface.
fn distance(p: Vec3) -> f32 {
    let sides = smax(p.x.abs() - HALF, p.z.abs() - HALF, 0.04);
    smax(smax(p.y - height(p), -p.y, 0.02), sides, 0.03)
}

/// 1 on the upper side, away from its edge.
fn scalp(p: Vec3) -> f32 {
    let edge = HALF - p.x.abs().max(p.z.abs());
    smoothstep(0.015, 0.035, edge) * smoothstep(-0.012, -0.006, p.y - height(p))
}
