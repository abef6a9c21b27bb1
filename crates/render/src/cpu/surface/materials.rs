//! The materials of a body in a picture: what a place on a triangle shows.

use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};
use lovelock_motion::{Alpha, Body, Skin};
use lovelock_picture::BodyLook;

use super::edges::{Edges, faces_away};
use crate::cpu::body_depth::Holes;
use crate::surface_material::SurfaceMaterial;
use crate::textures::{BodyTextures, MaterialTextures, Texture, coordinate, level_of_detail, share};

/// The materials of the body, with what the settings of the picture make of them.
#[derive(Clone, Debug)]
pub(crate) struct PlacedMaterials {
    pub textures: Arc<BodyTextures>,
    pub records: Vec<SurfaceMaterial>,
}

impl PlacedMaterials {
    /// Those of a body; `None` if it has none.
    pub fn of(body: &Body, look: &BodyLook) -> Option<Self> {
        let textures = BodyTextures::of(body)?;
        let records = textures.materials.iter().map(|material| SurfaceMaterial::new(material, look));
        Some(Self { records: records.collect(), textures })
    }

    /// The material of a triangle.
    pub fn of_triangle(&self, body: &Body, triangle: u32) -> usize {
        self.textures.material_of(body, triangle as usize)
    }

    /// Whether the back of a triangle is not drawn.
    pub fn is_culled(&self, body: &Body, triangle: u32) -> bool {
        !self.textures.materials[self.of_triangle(body, triangle)].is_double_sided
    }
}

/// What is the same for all places of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    pub id: u32,
    pub edges: Edges,
    pub material: usize,
    /// 1, or -1 if the back is seen.
    pub side: f32,
    /// Where the columns and the rows of the normal map go on the surface.
    pub tangents: Option<[Vec3; 2]>,
}

impl PlacedMaterials {
    /// The triangle `id`, projected to `corners` (pixels times w, and w).
    pub fn facet(
        &self,
        (body, skin): (&Body, &Skin),
        id: u32,
        corners: [[f32; 3]; 3],
        origin: [f32; 2],
    ) -> Option<Facet> {
        let edges = Edges::new(corners, origin)?;
        let material = self.of_triangle(body, id);
        let side = if faces_away(corners) { -1.0 } else { 1.0 };
        let normal_map = self.textures.of[material].normal;
        let tangents = normal_map.and_then(|(texture, _)| tangents(body, skin, id, &texture));
        Some(Facet { id, edges, material, side, tangents })
    }

    fn look_up_at(&self, texture: &Texture, at: Vec2, lod: f32) -> Vec4 {
        let chain = &self.textures.chains[texture.chain];
        chain.at(texture.transform.transform_point2(at), lod, texture.sampling)
    }

    /// The level of detail where the coordinates change by `dx` and `dy` from pixel to pixel.
    fn level(&self, texture: &Texture, [dx, dy]: [Vec2; 2]) -> f32 {
        let chain = &self.textures.chains[texture.chain];
        let turn = texture.transform.matrix2;
        level_of_detail(turn * dx, turn * dy, chain.levels[0].size)
    }
}

/// Which parts of surfaces are not there because they are not opaque.
#[derive(Clone, Copy)]
pub(crate) struct Cutouts<'a> {
    pub materials: &'a PlacedMaterials,
    pub body: &'a Body,
}

/// A triangle with holes.
pub(crate) struct CutTriangle<'a> {
    cutouts: Cutouts<'a>,
    textures: &'a MaterialTextures,
    material: usize,
    corners: [u32; 3],
    alpha: Alpha,
}

impl<'a> Cutouts<'a> {
    /// Whether any triangle may have holes.
    pub fn any(self) -> bool {
        self.materials.textures.materials.iter().any(|material| material.alpha != Alpha::Opaque)
    }

    /// The triangle `id` if it may have holes.
    pub fn of(self, id: u32) -> Option<CutTriangle<'a>> {
        let material = self.materials.of_triangle(self.body, id);
        let textures = &self.materials.textures;
        let alpha = textures.materials[material].alpha;
        (alpha != Alpha::Opaque).then(|| CutTriangle {
            cutouts: self,
            textures: &textures.of[material],
            material,
            corners: self.body.mesh.triangles[id as usize],
            alpha,
        })
    }
}

impl Holes for Cutouts<'_> {
    fn has_holes(&self, triangle: u32) -> bool {
        self.of(triangle).is_some()
    }

    fn blocks(&self, triangle: u32, shares: [f32; 3], steps: [[f32; 3]; 2]) -> bool {
        self.of(triangle).is_none_or(|cut| cut.blocks(shares, steps))
    }
}

/// The opacity at a place.
#[derive(Clone, Copy, Debug)]
struct Opacity {
    /// That of the vertices and of the texture.
    own: f32,
    texture: f32,
    /// How far the texture of a mask is the share of it that is shown, as in all levels but the first ([`Content::Mask`]): 0 to 1.
    ///
    /// [`Content::Mask`]: crate::textures::Content::Mask
    far: f32,
}

impl Opacity {
    /// Whether a mask is there: near, by its cutoff; far, by a threshold that so many samples pass as are shown. Twin of the function in
    /// `material_draw.wgsl`.
    fn is_in_mask(self, cutoff: f32, threshold: f32) -> bool {
        let shown = if self.own >= cutoff { 1.0 } else { 0.0 };
        let value = self.texture * (self.own + (shown - self.own) * self.far);
        value >= cutoff + (threshold - cutoff) * self.far
    }
}

impl CutTriangle<'_> {
    /// The opacity at a place of the triangle.
    fn opacity(&self, shares: [f32; 3], steps: impl Fn([Vec2; 3], Vec2) -> [Vec2; 2]) -> Opacity {
        let mesh = &self.cutouts.body.mesh;
        let own = mixed(&mesh.opacity, self.corners, shares).unwrap_or(1.0);
        let Some(texture) = &self.textures.base else { return Opacity { own, texture: 1.0, far: 0.0 } };
        let corners = self.corners.map(|i| coordinate(&mesh.coordinates[texture.set & 1], i as usize));
        let at = corners[0] * shares[0] + corners[1] * shares[1] + corners[2] * shares[2];
        let materials = self.cutouts.materials;
        let lod = materials.level(texture, steps(corners, at));
        let has_levels = materials.textures.chains[texture.chain].levels.len() > 1;
        Opacity {
            own,
            texture: materials.look_up_at(texture, at, lod).w,
            far: if has_levels { lod.clamp(0.0, 1.0) } else { 0.0 },
        }
    }

    /// Whether the sample `k` of the pixel at `pixel` shows the triangle, which has the barycentric coordinates `shares` up to a factor
    /// there.
    pub fn shows(&self, edges: &Edges, shares: [f32; 3], pixel: [u32; 2], k: usize) -> bool {
        let sum = shares[0] + shares[1] + shares[2];
        if sum <= 0.0 {
            return false;
        }
        let opacity =
            self.opacity(shares.map(|share| share / sum), |corners, at| steps_of(edges, sum, corners, at));
        match self.alpha {
            Alpha::Opaque => true,
            Alpha::Mask(cutoff) => opacity.is_in_mask(cutoff, threshold(pixel, k, self.material)),
            Alpha::Blend => opacity.own * opacity.texture >= threshold(pixel, k, self.material),
        }
    }

    /// See [`Holes::blocks`].
    fn blocks(&self, shares: [f32; 3], steps: [[f32; 3]; 2]) -> bool {
        let opacity = self.opacity(shares, |corners, _| {
            steps.map(|step| corners[0] * step[0] + corners[1] * step[1] + corners[2] * step[2])
        });
        match self.alpha {
            Alpha::Opaque => true,
            Alpha::Mask(cutoff) => opacity.is_in_mask(cutoff, BLOCKING),
            Alpha::Blend => opacity.own * opacity.texture >= BLOCKING,
        }
    }
}

/// The opacity from which a blended surface blocks light. Twin of the constant in `material_depth.wgsl`.
const BLOCKING: f32 = 0.5;

/// The opacity above which a blended surface is seen in sample `k` of a pixel: all 64 thresholds stand in each square of 4 by 4 pixels
/// (Bayer 1973), so that a surface of an even opacity covers just that share of it. Surfaces of several materials have other orders, so
/// that one does not hide always the same samples as the other. Twin of the function in `material_surface.wgsl`.
fn threshold([x, y]: [u32; 2], k: usize, material: usize) -> f32 {
    let shift = material as u32;
    let (x, y) = ((x + shift) & 3, (y + (shift >> 2) + shift) & 3);
    let (low, high) = ((x ^ y) & 1, ((x ^ y) >> 1) & 1);
    let place = low << 3 | (y & 1) << 2 | high << 1 | y >> 1;
    let sample = (k as u32 + shift) & 3;
    ((sample << 4 | place) as f32 + 0.5) * (1.0 / 64.0)
}

/// How coordinates change from pixel to pixel where they are `at` and the barycentric coordinates sum to `sum`.
fn steps_of(edges: &Edges, sum: f32, corners: [Vec2; 3], at: Vec2) -> [Vec2; 2] {
    let inverse = 1.0 / sum.max(1e-12);
    [0, 1].map(|axis| {
        let [a, b, c] = edges.planes.map(|plane| plane[axis]);
        (corners[0] * a + corners[1] * b + corners[2] * c - at * (a + b + c)) * inverse
    })
}

pub(super) fn mixed(of: &[f32], corners: [u32; 3], shares: [f32; 3]) -> Option<f32> {
    if of.is_empty() {
        return None;
    }
    let at = |corner: usize| share(of, corners[corner] as usize) * shares[corner];
    Some(at(0) + at(1) + at(2))
}

/// Where the columns and the rows of a texture go on a triangle, from the derivatives of position by coordinates; `None` where the
/// coordinates have no area.
fn tangents(body: &Body, skin: &Skin, id: u32, texture: &Texture) -> Option<[Vec3; 2]> {
    let corners = body.mesh.triangles[id as usize];
    let of = &body.mesh.coordinates[texture.set & 1];
    let [a, b, c] = corners.map(|i| texture.transform.transform_point2(coordinate(of, i as usize)));
    let [p, q, r] = corners.map(|i| skin.positions[i as usize]);
    let (e, f, u, v) = (q - p, r - p, b - a, c - a);
    let sign = 1.0_f32.copysign(u.perp_dot(v));
    let (right, down) = ((e * v.y - f * u.y) * sign, (f * u.x - e * v.x) * sign);
    let is_some = right.length_squared() > 0.0 && down.length_squared() > 0.0;
    (is_some && right.is_finite() && down.is_finite()).then_some([right, down])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blended_surface_covers_as_many_samples_as_it_is_opaque() {
        for material in 0..9 {
            let mut all: Vec<f32> =
                (0..64).map(|i| threshold([i % 4 + 8, i / 4 % 4 + 4], i as usize / 16, material)).collect();
            all.sort_by(f32::total_cmp);
            let wanted: Vec<f32> = (0..64).map(|i| (i as f32 + 0.5) / 64.0).collect();
            assert_eq!(all, wanted, "material {material}");
        }
        // Two surfaces of half opacity over each other: a quarter is seen through, not all or nothing.
        let through = |m: usize, n: usize| {
            let is_open = |i: u32, m| threshold([i % 4, i / 4 % 4], i as usize / 16, m) >= 0.5;
            (0..64).filter(|&i| is_open(i, m) && is_open(i, n)).count()
        };
        println!("{} {} {}", through(0, 1), through(0, 2), through(1, 2));
        assert!((8..=24).contains(&through(0, 1)));
    }
}
