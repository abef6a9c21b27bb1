//! Collects the triangles of all meshes in one surface in bind space.

use std::collections::BTreeMap;

use glam::Vec3;

use super::{
    accessor::Accessors,
    document::{Document, Primitive},
    normals::fill_normals,
    skin::{VertexWeights, read_vertex_weights},
};
use crate::{Mesh, MorphTarget, MotionError, SkinData};

/// Largest number of vertices of a character; drawing more would take minutes per frame.
const VERTEX_LIMIT: usize = 8_000_000;
/// Largest number of triangles of a character.
const TRIANGLE_LIMIT: usize = 16_000_000;
/// Larger coordinates are errors of the file: ten kilometres in the smallest common unit.
const FAR: f32 = 1e7;

/// Default colour of a surface: a warm, matt clay.
const CLAY: Vec3 = Vec3::new(0.52, 0.40, 0.34);

/// The surface under construction.
#[derive(Default)]
pub(super) struct Surface {
    pub(super) mesh: Mesh,
    pub(super) skin: SkinData,
    has_scalp: bool,
}

/// What moves the vertices of a primitive.
pub(super) enum Binding<'a> {
    /// A skin: the palette entries of its joints.
    Skin(&'a [u16]),
    /// One node: its palette entry.
    Rigid(u16),
}

impl Surface {
    /// Adds the morph targets of one mesh and returns the number of the first.
    pub(super) fn add_morphs(&mut self, names: &[String], weights: &[f32], count: usize) -> usize {
        let first = self.skin.morphs.len();
        for t in 0..count {
            let rest_weight = weights.get(t).copied().filter(|w| w.is_finite()).unwrap_or(0.0);
            let name = names.get(t).cloned().unwrap_or_else(|| format!("morph {t}"));
            self.skin.morphs.push(MorphTarget { name, rest_weight, ..MorphTarget::default() });
        }
        first
    }

    /// Adds one primitive. Vertices that are not finite are dropped with their triangles.
    pub(super) fn add(
        &mut self,
        accessors: &Accessors,
        primitive: &Primitive,
        binding: &Binding,
        first_morph: usize,
        dropped: &mut BTreeMap<String, u64>,
    ) -> Result<(), MotionError> {
        let mut drop = |what: &str, count: usize| {
            if count > 0 {
                *dropped.entry(what.into()).or_default() += count as u64;
            }
        };
        let mode = primitive.mode.unwrap_or(4);
        let Some(&position_accessor) =
            primitive.attributes.get("POSITION").filter(|_| (4..=6).contains(&mode))
        else {
            drop("primitives_without_triangles", 1);
            return Ok(());
        };
        refuse_draco(accessors, primitive, position_accessor)?;
        let positions = accessors.read::<3>(position_accessor)?;
        let count = positions.len();
        let same_count = |accessor: usize| match accessors.count(accessor)? {
            n if n == count as u64 => Ok(accessor),
            n => Err(MotionError::malformed(
                accessors.file,
                format!("accessor {accessor}"),
                format!("{n} elements; the mesh has {count} vertices"),
            )),
        };
        let attribute = |name: &str| primitive.attributes.get(name).map(|&a| same_count(a)).transpose();
        let base = self.skin.positions.len();
        if base + count > VERTEX_LIMIT {
            let problem = format!("more than {VERTEX_LIMIT} vertices");
            return Err(MotionError::malformed(accessors.file, "the meshes", problem));
        }

        // New index of each vertex of the primitive; `None` if it is dropped.
        let mut next = base as u32;
        let slot: Vec<Option<u32>> = positions
            .iter()
            .map(|p| {
                let usable = p.iter().all(|c| c.is_finite() && c.abs() < FAR);
                next += u32::from(usable);
                usable.then(|| next - 1)
            })
            .collect();
        drop("vertices", count - (next as usize - base));
        let kept = |v: &usize| slot[*v].is_some();

        let triangles_before = self.mesh.triangles.len();
        let corners = read_corners(accessors, primitive, count)?;
        if self.mesh.triangles.len() + corners.len() / 3 > TRIANGLE_LIMIT {
            let problem = format!("more than {TRIANGLE_LIMIT} triangles");
            return Err(MotionError::malformed(accessors.file, "the meshes", problem));
        }
        let triangles = triangulate(&corners, mode);
        let before = triangles.len();
        let place = |corner: u32| slot.get(corner as usize).copied().flatten();
        self.mesh
            .triangles
            .extend(triangles.into_iter().filter_map(|[a, b, c]| Some([place(a)?, place(b)?, place(c)?])));
        drop("triangles", before - (self.mesh.triangles.len() - triangles_before));

        let normals = attribute("NORMAL")?.map(|a| accessors.read::<3>(a)).transpose()?;
        let colors = attribute("COLOR_0")?.map(|a| accessors.read_3_or_4(a)).transpose()?;
        let scalp = attribute("_SCALP")?.map(|a| accessors.read::<1>(a)).transpose()?;
        let factor = base_color(accessors.document, primitive.material, colors.is_some());
        let influences = match binding {
            Binding::Skin(skin) if primitive.attributes.contains_key("JOINTS_0") => {
                read_vertex_weights(accessors, primitive, count, skin, dropped)?
            }
            Binding::Skin(skin) => vec![VertexWeights::rigid(skin.first().copied().unwrap_or(0)); count],
            Binding::Rigid(bind) => vec![VertexWeights::rigid(*bind); count],
        };
        self.skin.positions.extend((0..count).filter(kept).map(|v| Vec3::from(positions[v])));
        for v in (0..count).filter(kept) {
            let normal = normals.as_ref().map_or(Vec3::ZERO, |n| Vec3::from(n[v]));
            self.skin.normals.push(if normal.is_finite() { normal.normalize_or_zero() } else { Vec3::ZERO });
            let color = colors.as_ref().map_or(Vec3::ONE, |c| Vec3::new(c[v][0], c[v][1], c[v][2])) * factor;
            self.mesh.colors.push(if color.is_finite() {
                color.clamp(Vec3::ZERO, Vec3::ONE)
            } else {
                factor
            });
            self.mesh.scalp.push(scalp.as_ref().map_or(0.0, |s| s[v][0].clamp(0.0, 1.0)));
            self.skin.binds.push(influences[v].binds);
            self.mesh.weights.push(influences[v].weights);
        }
        self.has_scalp |= scalp.is_some();
        fill_normals(
            &self.skin.positions,
            &self.mesh.triangles[triangles_before..],
            base,
            &mut self.skin.normals,
        );
        for (t, target) in primitive.targets.iter().enumerate() {
            let read = |name: &str| -> Result<Option<Vec<[f32; 3]>>, MotionError> {
                target.get(name).map(|&a| accessors.read::<3>(same_count(a)?)).transpose()
            };
            let (moves, turns) = (read("POSITION")?, read("NORMAL")?);
            let Some(morph) = self.skin.morphs.get_mut(first_morph + t) else { break };
            for v in (0..count).filter(kept) {
                let at =
                    |deltas: &Option<Vec<[f32; 3]>>| deltas.as_ref().map_or(Vec3::ZERO, |d| Vec3::from(d[v]));
                let (dp, dn) = (at(&moves), at(&turns));
                if (dp != Vec3::ZERO || dn != Vec3::ZERO) && dp.is_finite() && dn.is_finite() {
                    morph.vertices.push(slot[v].unwrap_or(0));
                    morph.positions.push(dp);
                    morph.normals.push(dn);
                }
            }
        }
        Ok(())
    }

    /// Finishes the surface: without a scalp mask in any primitive the mask is empty.
    pub(super) fn finish(mut self) -> (Mesh, SkinData) {
        if !self.has_scalp {
            self.mesh.scalp = Vec::new();
        }
        self.mesh.joints = self
            .skin
            .binds
            .iter()
            .map(|binds| binds.map(|b| self.skin.palette[usize::from(b)].joint))
            .collect();
        (self.mesh, self.skin)
    }
}

/// Positions that exist only in compressed form would be read as zeros.
fn refuse_draco(accessors: &Accessors, primitive: &Primitive, positions: usize) -> Result<(), MotionError> {
    let empty = |a: &super::document::Accessor| a.buffer_view.is_none() && a.sparse.is_none();
    let name = super::DRACO;
    if primitive.extensions.contains_key(name)
        && accessors.document.accessors.get(positions).is_some_and(empty)
    {
        return Err(super::refuse(accessors.file, name));
    }
    Ok(())
}

fn base_color(document: &Document, material: Option<usize>, has_vertex_colors: bool) -> Vec3 {
    match material.and_then(|m| document.materials.get(m)) {
        Some(material) => material
            .pbr_metallic_roughness
            .base_color_factor
            .map_or(Vec3::ONE, |[r, g, b, _]| Vec3::new(r, g, b)),
        None if has_vertex_colors => Vec3::ONE,
        None => CLAY,
    }
}

fn read_corners(
    accessors: &Accessors,
    primitive: &Primitive,
    vertices: usize,
) -> Result<Vec<u32>, MotionError> {
    match primitive.indices {
        Some(accessor) => Ok(accessors.read_indices::<1>(accessor)?.into_iter().map(|[i]| i).collect()),
        None => Ok((0..vertices as u32).collect()),
    }
}

/// Triangles of a list (mode 4), a strip (5) or a fan (6); glTF 2.0, section 3.7.2.1.
fn triangulate(corners: &[u32], mode: u32) -> Vec<[u32; 3]> {
    match mode {
        5 => corners
            .windows(3)
            .enumerate()
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
            .collect(),
        6 => corners.windows(2).skip(1).map(|w| [w[0], w[1], corners[0]]).collect(),
        _ => corners.as_chunks::<3>().0.to_vec(),
    }
}
