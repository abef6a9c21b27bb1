//! Reads primitives as pieces of a surface in bind space.

use std::collections::BTreeMap;

use glam::Vec3;

use lovelock_base::words::counted;
use lovelock_gltf::document::{Accessor, Document, Primitive};
use lovelock_gltf::{Accessors, DRACO, GltfError};

use super::skin::read_vertex_weights;
use crate::MotionError;
use crate::surface::{CLAY, MorphPiece, Piece, VertexWeights};

/// What moves the vertices of a primitive.
pub(super) enum Binding<'a> {
    /// A skin: the palette entries of its joints.
    Skin(&'a [u16]),
    /// One node: its palette entry.
    Rigid(u16),
}

/// Reads one primitive. Primitives without triangles are dropped and counted.
pub(super) fn read_primitive(
    accessors: &Accessors,
    primitive: &Primitive,
    binding: &Binding,
    first_morph: usize,
    dropped: &mut BTreeMap<String, u64>,
) -> Result<Option<Piece>, MotionError> {
    let mode = primitive.mode.unwrap_or(4);
    let Some(&position_accessor) = primitive.attributes.get("POSITION").filter(|_| (4..=6).contains(&mode))
    else {
        *dropped.entry("primitives_without_triangles".into()).or_default() += 1;
        return Ok(None);
    };
    refuse_draco(accessors, primitive, position_accessor)?;
    let positions: Vec<Vec3> = accessors.read::<3>(position_accessor)?.into_iter().map(Vec3::from).collect();
    let count = positions.len();
    let same_count = |accessor: usize| match accessors.count(accessor)? {
        n if n == count as u64 => Ok(accessor),
        n => Err(MotionError::malformed(
            accessors.file,
            format!("accessor {accessor}"),
            format!(
                "{}; the mesh has {}",
                counted(n, "element", "elements"),
                counted(count, "vertex", "vertices")
            ),
        )),
    };
    let attribute = |name: &str| primitive.attributes.get(name).map(|&a| same_count(a)).transpose();
    let vectors = |accessor: Option<usize>| -> Result<Vec<Vec3>, MotionError> {
        let Some(accessor) = accessor else { return Ok(Vec::new()) };
        Ok(accessors.read::<3>(accessor)?.into_iter().map(Vec3::from).collect())
    };
    let corners = read_corners(accessors, primitive, count)?;
    let colors = attribute("COLOR_0")?.map(|a| accessors.read_3_or_4(a)).transpose()?;
    let scalp = attribute("_SCALP")?.map(|a| accessors.read::<1>(a)).transpose()?;
    let weights = match binding {
        Binding::Skin(skin) if primitive.attributes.contains_key("JOINTS_0") => {
            read_vertex_weights(accessors, primitive, count, skin, dropped)?
        }
        Binding::Skin(skin) => vec![VertexWeights::rigid(skin.first().copied().unwrap_or(0)); count],
        Binding::Rigid(bind) => vec![VertexWeights::rigid(*bind); count],
    };
    let mut morphs = Vec::with_capacity(primitive.targets.len());
    for (t, target) in primitive.targets.iter().enumerate() {
        let read = |name: &str| vectors(target.get(name).map(|&a| same_count(a)).transpose()?);
        let (moves, turns) = (read("POSITION")?, read("NORMAL")?);
        let at = |deltas: &[Vec3], v: usize| deltas.get(v).copied().unwrap_or_default();
        let moved = (0..count)
            .map(|v| (v as u32, at(&moves, v), at(&turns, v)))
            .filter(|(_, dp, dn)| *dp != Vec3::ZERO || *dn != Vec3::ZERO)
            .collect();
        morphs.push(MorphPiece { morph: first_morph + t, moved });
    }
    Ok(Some(Piece {
        positions,
        normals: vectors(attribute("NORMAL")?)?,
        color: base_color(accessors.document, primitive.material, colors.is_some()),
        colors: colors.map_or_else(Vec::new, |c| c.iter().map(|c| Vec3::new(c[0], c[1], c[2])).collect()),
        scalp: scalp.map_or_else(Vec::new, |s| s.into_iter().map(|[s]| s).collect()),
        weights,
        triangles: triangulate(&corners, mode),
        morphs,
    }))
}

/// Positions that exist only in compressed form would be read as zeros.
fn refuse_draco(accessors: &Accessors, primitive: &Primitive, positions: usize) -> Result<(), MotionError> {
    let empty = |a: &Accessor| a.buffer_view.is_none() && a.sparse.is_none();
    if primitive.extensions.contains_key(DRACO)
        && accessors.document.accessors.get(positions).is_some_and(empty)
    {
        return Err(GltfError::extension(accessors.file, DRACO).into());
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
