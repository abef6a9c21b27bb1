//! A surface under construction: the triangles of all meshes of a file, in bind space.

mod corners;
mod normals;
mod weights;

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use crate::{Mesh, MorphTarget, SkinData};
pub(crate) use corners::Corners;
use normals::fill_normals;
pub(crate) use weights::{Palette, VertexWeights, WeightSums};

/// Largest number of vertices of a character; drawing more would take minutes per frame.
const VERTEX_LIMIT: usize = 8_000_000;
/// Largest number of triangles of a character.
const TRIANGLE_LIMIT: usize = 16_000_000;
/// Larger coordinates are errors of the file: ten kilometres in the smallest common unit.
const FAR: f32 = 1e7;

/// Larger texture coordinates are errors of the file: single precision has no pixels left there.
const FAR_COORDINATE: f32 = 1e5;

/// Default colour of a surface: a warm, matt clay.
pub(crate) const CLAY: Vec3 = Vec3::new(0.52, 0.40, 0.34);

/// A part of a surface, such as the triangles of one material. Lists that may be empty say so; the others have one entry per vertex.
#[derive(Default)]
pub(crate) struct Piece {
    /// Positions in bind space.
    pub(crate) positions: Vec<Vec3>,
    /// Normals; may be empty.
    pub(crate) normals: Vec<Vec3>,
    /// Colours, linear sRGB; may be empty.
    pub(crate) colors: Vec<Vec3>,
    /// Colour by which all others are multiplied.
    pub(crate) color: Vec3,
    /// Opacity; empty if all are 1.
    pub(crate) opacity: Vec<f32>,
    /// Two sets of texture coordinates; each may be empty.
    pub(crate) coordinates: [Vec<Vec2>; 2],
    /// The share of light from all directions that creases let in; empty if all are 1.
    pub(crate) occlusion: Vec<f32>,
    /// 1 where hair grows; may be empty.
    pub(crate) scalp: Vec<f32>,
    /// Further masks by their names; may be empty.
    pub(crate) masks: BTreeMap<String, Vec<f32>>,
    /// Palette entries that move each vertex.
    pub(crate) weights: Vec<VertexWeights>,
    /// Counter-clockwise triangles; those with an index out of range are dropped.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Number of the material of each triangle; empty if all are 0.
    pub(crate) materials: Vec<u16>,
    /// What morph targets move.
    pub(crate) morphs: Vec<MorphPiece>,
}

/// What one morph target moves of a piece.
pub(crate) struct MorphPiece {
    /// Number of the morph target.
    pub(crate) morph: usize,
    /// Vertex, displacement and change of the normal at weight 1.
    pub(crate) moved: Vec<(u32, Vec3, Vec3)>,
}

/// The surface under construction.
#[derive(Default)]
pub(crate) struct Surface {
    mesh: Mesh,
    skin: SkinData,
    has: Has,
}

/// Which lists some piece has. The others are left empty.
#[derive(Default)]
struct Has {
    scalp: bool,
    opacity: bool,
    occlusion: bool,
    coordinates: [bool; 2],
}

impl Surface {
    /// Adds a morph target at the end and returns its number.
    pub(crate) fn add_morph(&mut self, name: String, rest_weight: f32) -> usize {
        let rest_weight = if rest_weight.is_finite() { rest_weight } else { 0.0 };
        self.skin.morphs.push(MorphTarget { name, rest_weight, ..MorphTarget::default() });
        self.skin.morphs.len() - 1
    }

    /// Number of morph targets.
    pub(crate) fn morphs(&self) -> usize {
        self.skin.morphs.len()
    }

    /// Adds a piece. Vertices that are not finite are dropped with their triangles.
    ///
    /// # Errors
    /// A problem as a sentence if the surface would have too many vertices or triangles.
    pub(crate) fn add(&mut self, piece: Piece, dropped: &mut BTreeMap<String, u64>) -> Result<(), String> {
        let mut drop = |what: &str, count: usize| {
            if count > 0 {
                *dropped.entry(what.into()).or_default() += count as u64;
            }
        };
        let count = piece.positions.len();
        let base = self.skin.positions.len();
        if base + count > VERTEX_LIMIT {
            return Err(format!("more than {VERTEX_LIMIT} vertices"));
        }
        if self.mesh.triangles.len() + piece.triangles.len() > TRIANGLE_LIMIT {
            return Err(format!("more than {TRIANGLE_LIMIT} triangles"));
        }
        // New index of each vertex of the piece; `None` if it is dropped.
        let mut next = base as u32;
        let slot: Vec<Option<u32>> = piece
            .positions
            .iter()
            .map(|p| {
                let usable = p.is_finite() && p.abs().max_element() < FAR;
                next += u32::from(usable);
                usable.then(|| next - 1)
            })
            .collect();
        drop("vertices", count - (next as usize - base));
        let place = |corner: u32| slot.get(corner as usize).copied().flatten();
        let before = self.mesh.triangles.len();
        let wanted = piece.triangles.len();
        for (t, &[a, b, c]) in piece.triangles.iter().enumerate() {
            if let (Some(a), Some(b), Some(c)) = (place(a), place(b), place(c)) {
                self.mesh.triangles.push([a, b, c]);
                self.mesh.materials.push(piece.materials.get(t).copied().unwrap_or(0));
            }
        }
        drop("triangles", wanted - (self.mesh.triangles.len() - before));
        let share = |list: &[f32], v: usize| match list.get(v) {
            Some(share) if share.is_finite() => share.clamp(0.0, 1.0),
            _ => 1.0,
        };
        let mut wrong_coordinates = 0;
        for v in (0..count).filter(|&v| slot[v].is_some()) {
            self.skin.positions.push(piece.positions[v]);
            let normal = piece.normals.get(v).copied().unwrap_or_default();
            self.skin.normals.push(if normal.is_finite() { normal.normalize_or_zero() } else { Vec3::ZERO });
            let color = piece.colors.get(v).copied().unwrap_or(Vec3::ONE) * piece.color;
            let color = if color.is_finite() { color } else { piece.color };
            self.mesh.colors.push(color.clamp(Vec3::ZERO, Vec3::ONE));
            self.mesh.opacity.push(share(&piece.opacity, v));
            self.mesh.occlusion.push(share(&piece.occlusion, v));
            for (all, own) in self.mesh.coordinates.iter_mut().zip(&piece.coordinates) {
                let at = own.get(v).copied().unwrap_or_default();
                let usable = at.is_finite() && at.abs().max_element() < FAR_COORDINATE;
                wrong_coordinates += usize::from(!usable);
                all.push(if usable { at } else { Vec2::ZERO });
            }
            self.mesh.scalp.push(piece.scalp.get(v).map_or(0.0, |s| s.clamp(0.0, 1.0)));
            self.skin.binds.push(piece.weights[v].binds);
            self.mesh.weights.push(piece.weights[v].weights);
        }
        drop("texture_coordinates", wrong_coordinates);
        self.has.scalp |= !piece.scalp.is_empty();
        self.has.opacity |= piece.opacity.iter().any(|&opacity| opacity < 1.0);
        self.has.occlusion |= !piece.occlusion.is_empty();
        for (has, own) in self.has.coordinates.iter_mut().zip(&piece.coordinates) {
            *has |= !own.is_empty();
        }
        for (name, values) in &piece.masks {
            let mask = self.mesh.masks.entry(name.clone()).or_default();
            // Other pieces are outside of it.
            mask.resize(base, 0.0);
            let kept = slot.iter().enumerate().filter(|(_, slot)| slot.is_some());
            let value = |v: usize| values.get(v).filter(|value| value.is_finite());
            mask.extend(kept.map(|(v, _)| value(v).map_or(0.0, |value| value.clamp(0.0, 1.0))));
        }
        fill_normals(&self.skin.positions, &self.mesh.triangles[before..], base, &mut self.skin.normals);
        for of_morph in piece.morphs {
            let Some(morph) = self.skin.morphs.get_mut(of_morph.morph) else { continue };
            for (v, position, normal) in of_morph.moved {
                let moves = position != Vec3::ZERO || normal != Vec3::ZERO;
                if let (Some(v), true) = (place(v), moves && position.is_finite() && normal.is_finite()) {
                    morph.vertices.push(v);
                    morph.positions.push(position);
                    morph.normals.push(normal);
                }
            }
        }
        Ok(())
    }

    /// Finishes the surface with the joints that its palette names. Lists that no piece has are empty.
    pub(crate) fn finish(mut self, palette: Palette) -> (Mesh, SkinData) {
        if !self.has.scalp {
            self.mesh.scalp = Vec::new();
        }
        if !self.has.opacity {
            self.mesh.opacity = Vec::new();
        }
        if !self.has.occlusion {
            self.mesh.occlusion = Vec::new();
        }
        for (list, has) in self.mesh.coordinates.iter_mut().zip(self.has.coordinates) {
            if !has {
                *list = Vec::new();
            }
        }
        for mask in self.mesh.masks.values_mut() {
            mask.resize(self.skin.positions.len(), 0.0);
        }
        self.skin.palette = palette.into_binds();
        let joint_of = |bind: u16| self.skin.palette.get(usize::from(bind)).map_or(0, |bind| bind.joint);
        self.mesh.joints = self.skin.binds.iter().map(|binds| binds.map(joint_of)).collect();
        (self.mesh, self.skin)
    }
}
