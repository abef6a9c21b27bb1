//! The body on the CPU: projected once per frame, rasterised per tile, shaded where it is visible.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

mod edges;
pub(super) mod light;
mod lookup;
mod material_shading;
pub(super) mod materials;
mod places;
pub(super) mod raster;
mod reflectance;
mod seeds;
pub(super) mod shading;

use std::sync::Arc;

use glam::{Mat4, Vec3};
use lovelock_base::memory::list_bytes;
use lovelock_motion::{Body, Skin};
use lovelock_picture::BodyLook;
use rayon::prelude::*;

use self::edges::faces_away;
use self::materials::PlacedMaterials;
use super::bins::{Bins, TileRange};
use super::tile::{Grid, TILE};
use crate::camera::NEAR_METRES;
use crate::skin::ScalpPaint;

/// Interpolated attributes of a vertex, contiguous in memory: position, normal, colour, 1 where hair grows, transmittance of hair
/// toward four lights, two unused.
pub(super) type Attributes = [f32; 16];

/// The projected body.
#[derive(Clone, Debug, Default)]
pub(super) struct PlacedSurface {
    /// Attributes per vertex.
    pub attributes: Vec<Attributes>,
    /// Pixels from the left and top times w, and w.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles that touch each tile.
    pub bins: Bins,
    /// The materials of the body, if it has any.
    pub materials: Option<PlacedMaterials>,
    materials_of: Option<(Arc<Body>, BodyLook)>,
    paint: ScalpPaint,
}

impl PlacedSurface {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.attributes)
            + list_bytes(&self.vertices)
            + self.bins.bytes()
            + list_bytes(&self.paint.values)
            + self.materials.as_ref().map_or(0, |materials| materials.textures.bytes())
    }

    /// Takes the materials of a body that looks as `look` says.
    pub fn follow_materials(&mut self, body: Option<&Arc<Body>>, look: &BodyLook) {
        let is_same =
            |(old, of): &(Arc<Body>, BodyLook)| body.is_some_and(|body| Arc::ptr_eq(old, body)) && of == look;
        if !self.materials_of.as_ref().is_some_and(is_same) {
            self.materials = body.and_then(|body| PlacedMaterials::of(body, look));
            self.materials_of = body.map(|body| (Arc::clone(body), *look));
        }
    }

    /// Projects the vertices and sorts the triangles into tiles. `hair` holds one word of packed transmittances per vertex; `closed`
    /// states that back faces need not be drawn.
    pub fn place(
        &mut self,
        clip_from_world: Mat4,
        grid: &Grid,
        body: Option<(&Arc<Body>, &Skin)>,
        (hair, closed): (&[u32], bool),
        look: &BodyLook,
    ) {
        self.follow_materials(body.map(|(body, _)| body), look);
        self.gather(body, hair);
        let none: (&[Vec3], &[[u32; 3]]) = (&[], &[]);
        let (positions, triangles) =
            body.map_or(none, |(body, skin)| (&skin.positions[..], &body.mesh.triangles[..]));
        let (width, height) = (grid.width as f32, grid.height as f32);
        positions
            .par_iter()
            .with_min_len(4096)
            .map(|p| {
                let at = clip_from_world * p.extend(1.0);
                [(at.x + at.w) * (0.5 * width), (at.w - at.y) * (0.5 * height), at.w]
            })
            .collect_into_vec(&mut self.vertices);
        let vertices = &self.vertices;
        let of = self.materials.as_ref().zip(body);
        self.bins.fill(triangles.len(), grid.columns, grid.rows, |i| {
            let mut corners = [[0.0; 3]; 3];
            for (corner, &at) in corners.iter_mut().zip(&triangles[i]) {
                *corner = *vertices.get(at as usize)?;
            }
            let one_sided = of.map_or(closed, |(materials, (body, _))| materials.is_culled(body, i as u32));
            if one_sided && faces_away(corners) { None } else { tiles_of(corners, grid) }
        });
    }

    fn gather(&mut self, body: Option<(&Arc<Body>, &Skin)>, hair: &[u32]) {
        self.attributes.clear();
        let Some((body, skin)) = body else { return };
        let mesh = &body.mesh;
        self.paint.follow(body);
        let paint = &self.paint.values;
        let positions = skin.positions.par_iter().with_min_len(4096);
        positions
            .enumerate()
            .map(|(i, p)| {
                let n = skin.normals.get(i).copied().unwrap_or(Vec3::Y);
                let color = mesh.colors.get(i).copied().unwrap_or(Vec3::splat(0.5));
                let scalp = paint.get(i).copied().unwrap_or(0.0);
                let word = hair.get(i).copied().unwrap_or(u32::MAX);
                let [a, b, c, d] = word.to_le_bytes().map(|byte| f32::from(byte) * (1.0 / 255.0));
                [p.x, p.y, p.z, n.x, n.y, n.z, color.x, color.y, color.z, scalp, a, b, c, d, 0.0, 0.0]
            })
            .collect_into_vec(&mut self.attributes);
    }
}

/// The tiles that a triangle may touch.
fn tiles_of(corners: [[f32; 3]; 3], grid: &Grid) -> Option<TileRange> {
    if !corners.as_flattened().iter().all(|c| c.is_finite()) || corners.iter().all(|c| c[2] <= NEAR_METRES) {
        return None;
    }
    let bounds = pixel_bounds(corners);
    grid.range(bounds.unwrap_or([0.0, 0.0, grid.width as f32, grid.height as f32]))
}

/// Left, top, right and bottom of a triangle in pixels; `None` if it crosses the near plane, where it may extend anywhere.
#[inline(always)]
pub(super) fn pixel_bounds(corners: [[f32; 3]; 3]) -> Option<[f32; 4]> {
    let mut bounds = [f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY];
    for [x, y, w] in corners {
        if w <= NEAR_METRES {
            return None;
        }
        let inverse = 1.0 / w;
        let (x, y) = (x * inverse, y * inverse);
        bounds = [bounds[0].min(x), bounds[1].min(y), bounds[2].max(x), bounds[3].max(y)];
    }
    Some(bounds)
}

const _: () = assert!(TILE.is_multiple_of(8), "rows of a tile are drawn eight pixels at a time");
