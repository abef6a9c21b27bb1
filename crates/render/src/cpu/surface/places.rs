//! Places on the surface that are shaded together: what they show is interpolated and looked up in full vectors.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use glam::Vec3;
use lovelock_base::simd_versions;
use lovelock_motion::{Body, Shading};

use super::lookup::CoordinatesOf;
use super::material_shading::{MaterialBatch, shade_materials};
use super::materials::{Facet, PlacedMaterials, mixed};
use super::seeds::PastBody;
use super::shading::LANES;
use super::{Attributes, PlacedSurface};
use crate::MAX_LIGHTS;
use crate::cpu::math::{clamp, max};
use crate::cpu::tile::SurfacePlanes;
use crate::cpu::view::View;
use crate::surface_material::{TOON, UNLIT};
use crate::textures::{USES, coordinate};

type Lane = [f32; LANES];

/// A part of a pixel that shows one triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// Index into the list of triangles, and that of its material.
    pub facet: u32,
    pub material: u32,
    /// The pixel in the tile, and its index in the planes.
    pub x: u16,
    pub y: u16,
    pub pixel: u32,
    /// The fraction of the pixel.
    pub weight: f32,
    /// Depth of the surface if it fills the pixel, and 0 otherwise.
    pub depth: f32,
    /// The share of each light that passes the body, if it is known.
    pub past_body: Option<PastBody>,
}

/// Parts of pixels of one material, at most [`LANES`], whose shadows by the body are either all known or none.
pub(super) struct PartsIn<'a> {
    pub surface: &'a PlacedSurface,
    pub materials: &'a PlacedMaterials,
    pub body: &'a Body,
    pub facets: &'a [Facet],
    pub parts: &'a [Part],
}

simd_versions! {
    /// [`shade_parts`] for the vectors of `width`.
    pub(super) fn shade_parts_simd(
        view: &View, input: &PartsIn, batch: &mut MaterialBatch, out: &mut SurfacePlanes
    ) -> () {
        shade_parts(view, input, batch, out)
    }
}

/// Shades parts of pixels and adds them to the planes.
#[inline(always)]
fn shade_parts(view: &View, input: &PartsIn, batch: &mut MaterialBatch, out: &mut SurfacePlanes) {
    let parts = input.parts;
    let (Some(first), true) = (parts.first(), parts.len() <= LANES) else { return };
    // Unused lanes repeat the last part, so that all lie close together in the maps.
    let part = |lane: usize| &parts[if lane < parts.len() { lane } else { parts.len() - 1 }];
    fill(input, first.material as usize, part, batch);
    batch.is_past_body_known = first.past_body.is_some();
    if batch.is_past_body_known {
        for lane in 0..LANES {
            let lit = part(lane).past_body.unwrap_or_default();
            (0..MAX_LIGHTS).for_each(|k| batch.past_body[k][lane] = lit[k]);
        }
    }
    shade_materials(view, batch);
    for (lane, part) in parts.iter().enumerate() {
        for (plane, color) in out.color.iter_mut().zip(&batch.color) {
            plane[part.pixel as usize] += part.weight * color[lane];
        }
    }
}

/// The edges of the triangles at each place: barycentric coordinates, and how they change from pixel to pixel.
struct Shares {
    of_corners: [Lane; 3],
    steps: [[Lane; 3]; 2],
    /// The inverse of the factor that the planes of the triangles have in common.
    inverse: Lane,
}

impl Shares {
    #[inline(always)]
    fn of<'a>(facet: impl Fn(usize) -> &'a Facet, at: &[Lane; 2]) -> Self {
        let mut shares = [[0.0; LANES]; 3];
        let mut steps = [[[0.0; LANES]; 3]; 2];
        let mut offset = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            let planes = &facet(lane).edges.planes;
            for i in 0..3 {
                (steps[0][i][lane], steps[1][i][lane], offset[i][lane]) =
                    (planes[i][0], planes[i][1], planes[i][2]);
            }
        }
        let mut sum = [0.0; LANES];
        for i in 0..3 {
            for lane in 0..LANES {
                let e = steps[0][i][lane] * at[0][lane] + steps[1][i][lane] * at[1][lane] + offset[i][lane];
                // The centre of a partly covered pixel may lie outside: it is moved into the triangle. Colours are not extrapolated
                // there: across a narrow triangle between two materials they change too fast.
                shares[i][lane] = max(e, 0.0);
                sum[lane] += shares[i][lane];
            }
        }
        let mut inverse = [0.0; LANES];
        for lane in 0..LANES {
            inverse[lane] = 1.0 / max(sum[lane], 1e-12);
        }
        for share in &mut shares {
            for lane in 0..LANES {
                share[lane] *= inverse[lane];
            }
        }
        for lane in 0..LANES {
            // Beside all of the triangle it is the first corner.
            shares[0][lane] += if sum[lane] > 0.0 { 0.0 } else { 1.0 };
        }
        Self { of_corners: shares, steps, inverse }
    }

    /// Texture coordinates from those of the corners.
    #[inline(always)]
    fn coordinates<'a>(
        &self,
        body: &Body,
        set: usize,
        facet: impl Fn(usize) -> &'a Facet,
    ) -> CoordinatesOf<LANES> {
        let of = &body.mesh.coordinates[set & 1];
        let mut corners = [[[0.0; LANES]; 2]; 3];
        for lane in 0..LANES {
            let triangle = body.mesh.triangles[facet(lane).id as usize];
            for (corner, i) in corners.iter_mut().zip(triangle) {
                let at = coordinate(of, i as usize);
                (corner[0][lane], corner[1][lane]) = (at.x, at.y);
            }
        }
        let none = [[0.0; LANES]; 2];
        let mut out = CoordinatesOf { at: none, dx: none, dy: none };
        for c in 0..2 {
            for lane in 0..LANES {
                let [p, q, r] = [corners[0][c][lane], corners[1][c][lane], corners[2][c][lane]];
                let [a, b, d] =
                    [self.of_corners[0][lane], self.of_corners[1][lane], self.of_corners[2][lane]];
                let at = p * a + q * b + r * d;
                out.at[c][lane] = at;
                let step = |steps: &[Lane; 3]| {
                    let [a, b, d] = [steps[0][lane], steps[1][lane], steps[2][lane]];
                    (p * a + q * b + r * d - at * (a + b + d)) * self.inverse[lane]
                };
                out.dx[c][lane] = step(&self.steps[0]);
                out.dy[c][lane] = step(&self.steps[1]);
            }
        }
        out
    }
}

/// Sets what the surface shows at each part.
#[inline(always)]
fn fill<'a>(
    input: &'a PartsIn,
    material: usize,
    part: impl Fn(usize) -> &'a Part,
    batch: &mut MaterialBatch,
) {
    let PartsIn { surface, materials, body, facets, parts } = input;
    let facet = |lane: usize| &facets[part(lane).facet as usize];
    let mut at = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        let part = part(lane);
        (at[0][lane], at[1][lane]) = (f32::from(part.x) + 0.5, f32::from(part.y) + 0.5);
    }
    let edges = Shares::of(facet, &at);
    let mut side = [0.0; LANES];
    for lane in 0..LANES {
        let facet = facet(lane);
        let [i, j, k] = body.mesh.triangles[facet.id as usize];
        let of = &surface.attributes;
        let corners = [&of[i as usize], &of[j as usize], &of[k as usize]];
        let mixed = mixed_attributes(corners, &edges.of_corners, lane);
        for axis in 0..3 {
            batch.position[axis][lane] = mixed[axis];
            batch.normal[axis][lane] = mixed[3 + axis];
            batch.albedo[axis][lane] = mixed[6 + axis];
        }
        batch.scalp[lane] = mixed[9];
        for k in 0..MAX_LIGHTS {
            batch.hair[k][lane] = mixed[10 + k];
        }
        side[lane] = facet.side;
    }
    batch.occlusion = [1.0; LANES];
    if !body.mesh.occlusion.is_empty() {
        for lane in 0..LANES {
            let corners = body.mesh.triangles[facet(lane).id as usize];
            let shares = [edges.of_corners[0][lane], edges.of_corners[1][lane], edges.of_corners[2][lane]];
            batch.occlusion[lane] =
                clamp(mixed(&body.mesh.occlusion, corners, shares).unwrap_or(1.0), 0.0, 1.0);
        }
    }

    let (record, textures) = (&materials.records[material], &materials.textures.of[material]);
    let of_body = &materials.textures.materials[material];
    // One loop for all textures, because a function that is called in several places is not compiled for the vectors of this one.
    let mut sets: [Option<CoordinatesOf<LANES>>; 2] = [None; 2];
    let mut texels = [[[1.0; LANES]; 4]; USES];
    let is_used = [
        true,
        true,
        of_body.emissive != Vec3::ZERO,
        record.model == TOON && textures.shade != textures.base,
        true,
    ];
    for ((texels, texture), is_used) in texels.iter_mut().zip(textures.uses()).zip(is_used) {
        let Some(texture) = texture.filter(|_| is_used) else { continue };
        let of = sets[texture.set & 1].get_or_insert_with(|| edges.coordinates(body, texture.set, facet));
        let chain = &materials.textures.chains[texture.chain];
        *texels = chain.at_places(of, parts.len(), &texture.transform, texture.sampling);
    }
    let [base, normals, emissive, shade, roughness] = &texels;
    let tint = record.tint.to_array();
    for c in 0..3 {
        for lane in 0..LANES {
            batch.albedo[c][lane] = batch.albedo[c][lane] * tint[c] * base[c][lane];
        }
    }
    for c in 0..3 {
        batch.bump[c] = batch.normal[c];
    }
    if let Some((_, strength)) = textures.normal {
        for lane in 0..LANES {
            let Some([right, down]) = facet(lane).tangents else { continue };
            let normal = Vec3::new(batch.normal[0][lane], batch.normal[1][lane], batch.normal[2][lane]);
            let texel = Vec3::new(normals[0][lane], normals[1][lane], normals[2][lane]);
            let tilt = (2.0 * texel - 1.0) * Vec3::new(strength, strength, 1.0);
            let normal = normal.normalize_or_zero();
            let across = |axis: Vec3| (axis - normal * normal.dot(axis)).normalize_or_zero();
            // Normal maps of glTF count upward, rows of an image downward.
            let bump = across(right) * tilt.x - across(down) * tilt.y + normal * tilt.z;
            (batch.bump[0][lane], batch.bump[1][lane], batch.bump[2][lane]) = (bump.x, bump.y, bump.z);
        }
    }
    for c in 0..3 {
        for lane in 0..LANES {
            batch.normal[c][lane] *= side[lane];
            batch.bump[c][lane] *= side[lane];
        }
    }
    let given_off = of_body.emissive.to_array();
    for c in 0..3 {
        for lane in 0..LANES {
            batch.emissive[c][lane] = given_off[c] * emissive[c][lane];
        }
    }
    batch.shade = [[0.0; LANES]; 3];
    if record.model == TOON {
        let shade = if textures.shade == textures.base { base } else { shade };
        let toon = if let Shading::Toon(toon) = of_body.shading { toon.shade } else { Vec3::ZERO };
        let toon = (toon * record.tint).to_array();
        for c in 0..3 {
            for lane in 0..LANES {
                batch.shade[c][lane] = toon[c] * shade[c][lane];
            }
        }
    }
    if record.model == UNLIT {
        for c in 0..3 {
            for lane in 0..LANES {
                batch.emissive[c][lane] += batch.albedo[c][lane];
            }
            batch.albedo[c] = [0.0; LANES];
        }
    }
    batch.set_material(record, &roughness[1]);
}

/// The attributes of three corners mixed by their shares.
#[inline(always)]
fn mixed_attributes([a, b, c]: [&Attributes; 3], shares: &[Lane; 3], lane: usize) -> Attributes {
    let mut mixed = Attributes::default();
    let [of_a, of_b, of_c] = [shares[0][lane], shares[1][lane], shares[2][lane]];
    for k in 0..mixed.len() {
        mixed[k] = a[k] * of_a + b[k] * of_b + c[k] * of_c;
    }
    mixed
}
