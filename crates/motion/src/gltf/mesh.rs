//! Reads primitives as pieces of a surface in bind space.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use lovelock_base::words::counted;
use lovelock_gltf::document::{Accessor, Primitive};
use lovelock_gltf::{Accessors, DRACO, GltfError};

use super::material::Coat;
use super::skin::read_vertex_weights;
use crate::MotionError;
use crate::surface::{MorphPiece, Piece, VertexWeights};

/// What moves the vertices of a primitive.
pub(super) enum Binding<'a> {
    /// A skin: the palette entries of its joints.
    Skin(&'a [u16]),
    /// One node: its palette entry.
    Rigid(u16),
}

/// A primitive with what it takes from its material.
pub(super) type Part<'a> = (&'a Primitive, Coat);

/// Whether two primitives have the same vertices, so that these are read once. Normals that are missing depend on the triangles, so they
/// are not shared.
pub(super) fn share_vertices((a, coat_a): &Part, (b, coat_b): &Part) -> bool {
    let is_surface = |of: &Primitive| (4..=6).contains(&of.mode.unwrap_or(4)) && of.extensions.is_empty();
    is_surface(a)
        && is_surface(b)
        && a.attributes.contains_key("NORMAL")
        && a.attributes == b.attributes
        && a.targets == b.targets
        && coat_a.color == coat_b.color
        && coat_a.opacity.unwrap_or(1.0) == coat_b.opacity.unwrap_or(1.0)
}

/// Reads primitives that share their vertices; of several, [`share_vertices`] must hold. Primitives without triangles are dropped and
/// counted.
pub(super) fn read_primitives(
    accessors: &Accessors,
    parts: &[Part],
    binding: &Binding,
    first_morph: usize,
    dropped: &mut BTreeMap<String, u64>,
) -> Result<Option<Piece>, MotionError> {
    let Some(&(primitive, coat)) = parts.first() else { return Ok(None) };
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
    let (mut triangles, mut materials) = (Vec::new(), Vec::new());
    for (primitive, coat) in parts {
        let corners = read_corners(accessors, primitive, count)?;
        triangles.extend(triangulate(&corners, primitive.mode.unwrap_or(4)));
        materials.resize(triangles.len(), coat.material);
    }
    let colors = attribute("COLOR_0")?.map(|a| accessors.read_3_or_4(a)).transpose()?;
    let scalp = attribute("_SCALP")?.map(|a| accessors.read::<1>(a)).transpose()?;
    let weights = match binding {
        Binding::Skin(skin) if primitive.attributes.contains_key("JOINTS_0") => {
            read_vertex_weights(accessors, primitive, count, skin, dropped)?
        }
        Binding::Skin(skin) => vec![VertexWeights::rigid(skin.first().copied().unwrap_or(0)); count],
        Binding::Rigid(bind) => vec![VertexWeights::rigid(*bind); count],
    };
    // What only colours a surface is left out where it is wrong.
    let mut optional = |name: &str| {
        attribute(name).unwrap_or_else(|_| {
            *dropped.entry("attributes".into()).or_default() += 1;
            None
        })
    };
    let sets = ["TEXCOORD_0", "TEXCOORD_1"].map(&mut optional);
    let occlusion = optional("_OCCLUSION").and_then(|a| accessors.read::<1>(a).ok());
    let coordinates = sets.map(|set| {
        let set = set.and_then(|a| accessors.read::<2>(a).ok()).unwrap_or_default();
        set.into_iter().map(Vec2::from).collect::<Vec<_>>()
    });
    let mut morphs = Vec::with_capacity(primitive.targets.len());
    for (t, target) in primitive.targets.iter().enumerate() {
        let read = |name: &str| vectors(target.get(name).map(|&a| same_count(a)).transpose()?);
        let (Ok(moves), Ok(turns)) = (read("POSITION"), read("NORMAL")) else {
            *dropped.entry("morph_targets_of_other_meshes".into()).or_default() += 1;
            continue;
        };
        let at = |deltas: &[Vec3], v: usize| deltas.get(v).copied().unwrap_or_default();
        let moved = (0..count)
            .map(|v| (v as u32, at(&moves, v), at(&turns, v)))
            .filter(|(_, dp, dn)| *dp != Vec3::ZERO || *dn != Vec3::ZERO)
            .collect();
        morphs.push(MorphPiece { morph: first_morph + t, moved });
    }
    // Opaque materials do not use it.
    let opacity = match (parts.iter().find_map(|(_, coat)| coat.opacity), &colors) {
        (Some(factor), Some(colors)) => colors.iter().map(|color| factor * color[3]).collect(),
        (Some(factor), None) if factor < 1.0 => vec![factor; count],
        _ => Vec::new(),
    };
    Ok(Some(Piece {
        positions,
        normals: vectors(attribute("NORMAL")?)?,
        color: coat.color,
        colors: colors.map_or_else(Vec::new, |c| c.iter().map(|c| Vec3::new(c[0], c[1], c[2])).collect()),
        opacity,
        coordinates,
        occlusion: occlusion.map_or_else(Vec::new, |o| o.into_iter().map(|[o]| o).collect()),
        scalp: scalp.map_or_else(Vec::new, |s| s.into_iter().map(|[s]| s).collect()),
        masks: read_masks(accessors, primitive, count, dropped),
        weights,
        materials,
        triangles,
        morphs,
    }))
}

/// Attributes of files' own that are read elsewhere.
const NO_MASKS: [&str; 2] = ["_SCALP", "_OCCLUSION"];
/// The most masks of a primitive.
const MAX_MASKS: usize = 16;

/// The attributes of the file's own with one number per vertex. Those that cannot be read are dropped and counted.
fn read_masks(
    accessors: &Accessors,
    primitive: &Primitive,
    vertices: usize,
    dropped: &mut BTreeMap<String, u64>,
) -> BTreeMap<String, Vec<f32>> {
    let is_mask = |accessor: usize| {
        let found = accessors.document.accessors.get(accessor);
        found.is_some_and(|a| a.kind == "SCALAR" && a.count == vertices as u64)
    };
    let own = primitive.attributes.iter().filter(|(name, accessor)| {
        name.starts_with('_') && !NO_MASKS.contains(&name.as_str()) && is_mask(**accessor)
    });
    let mut masks = BTreeMap::new();
    for (name, &accessor) in own.take(MAX_MASKS) {
        let Ok(values) = accessors.read::<1>(accessor) else {
            *dropped.entry("attributes".into()).or_default() += 1;
            continue;
        };
        masks.insert(name.clone(), values.into_iter().map(|[value]| value).collect());
    }
    masks
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
