//! Characters and clips from USD stages: `Skeleton`, `SkelAnimation`, and meshes that are bound to skeletons.
//!
//! Joints, bind transforms and weights follow the schema `UsdSkel` (<https://openusd.org/release/api/_usd_skel__schemas.html>). One file
//! is read: what it refers to in others, and variants, are left out, and a note says so.

mod clip;
mod look;
mod mesh;
mod over_mesh;
mod package;
mod skeleton;

use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

use glam::{Affine3A, DMat4, Mat3A, Mat4};
use lovelock_base::words::counted;
use lovelock_usd::{CRATE_MAGIC, Layer, Source, TEXT_MAGIC, UsdError, Value, stage_space};

use self::look::{Files, Materials};
use crate::character::{Axes, Character, Draft, HiddenMeshes, WornHair, only_motion};
use crate::content::FigureContent;
use crate::surface::{Palette, Surface};
use crate::{BodySettings, MotionError};

/// Whether a file is a USD stage or package, by its first bytes.
pub(crate) fn is_usd(bytes: &[u8]) -> bool {
    bytes.starts_with(CRATE_MAGIC) || bytes.starts_with(TEXT_MAGIC) || package::is_package(bytes)
}

/// Whether a file is a binary crate of USD, by its first bytes.
pub(crate) fn is_crate(bytes: &[u8]) -> bool {
    bytes.starts_with(CRATE_MAGIC)
}

/// What a crate of a length in bytes contains. Only the tables of its prims are read, which are small beside their points.
pub(crate) fn crate_content(file: &str, data: File, length: u64) -> Result<FigureContent, MotionError> {
    let mut layer = lovelock_usd::open(file, Source::File(data, length), true)?;
    content_of(&mut *layer, false)
}

/// What a stage or package contains.
pub(crate) fn content(file: &str, bytes: &[u8]) -> Result<FigureContent, MotionError> {
    let is_package = package::is_package(bytes);
    let bytes = if is_package { package::first_layer(file, bytes)? } else { bytes };
    let mut layer = lovelock_usd::open(file, Source::Memory(bytes), is_crate(bytes))?;
    content_of(&mut *layer, is_package)
}

fn content_of(layer: &mut dyn Layer, is_package: bool) -> Result<FigureContent, MotionError> {
    // Curves that are not drawn, such as guides of a groom beside a body, do not make a file hair.
    let curves = if is_package { Vec::new() } else { layer.prims(&["BasisCurves"])? };
    let mut are_drawn = false;
    for &(prim, _) in curves.iter().take(MAX_LOOKED_AT) {
        are_drawn |= mesh::hidden(layer, prim)?.is_none();
    }
    let mut holds = |types: &[&str]| layer.prims(types).map(|prims| !prims.is_empty());
    Ok(if are_drawn || (!curves.is_empty() && !holds(&["Mesh"])?) {
        FigureContent::Curves
    } else if holds(&["Mesh"])? {
        FigureContent::Body
    } else if holds(&["SkelAnimation"])? {
        FigureContent::Clip
    } else {
        FigureContent::Nothing
    })
}

impl From<UsdError> for MotionError {
    fn from(error: UsdError) -> Self {
        match error {
            UsdError::Io { name, source } => Self::Read { file: name, source },
            UsdError::Malformed { name, offset, found, wanted } => Self::Malformed {
                file: name,
                place: format!("byte {offset}"),
                problem: format!("found {found}; must be {wanted}"),
            },
        }
    }
}

/// Reads a USD file. Without `needs_mesh` a file without a body is read too, and meshes are left out.
pub(crate) fn read(
    file: &str,
    bytes: &[u8],
    folder: Option<&Path>,
    settings: BodySettings,
    needs_mesh: bool,
) -> Result<Character, MotionError> {
    let is_package = package::is_package(bytes);
    let files = if is_package { Files::Package(bytes) } else { Files::Folder(folder) };
    let bytes = if is_package { package::first_layer(file, bytes)? } else { bytes };
    let is_crate = is_crate(bytes);
    let mut stage = lovelock_usd::open(file, Source::Memory(bytes), is_crate)?;
    let layer = &mut *stage;
    let mut notes = Vec::new();
    let mut dropped = BTreeMap::new();
    notes.extend(lovelock_usd::left_out_arcs(layer));
    let space = stage_space(layer)?;
    if !space.is_stated {
        notes.push("the file states no metersPerUnit; centimetres, the default of USD, are used".to_owned());
    }
    let (metres_from_stage, unit_metres) = (space.metres_from_stage, space.metres as f32);
    let figure = skeleton::Figure::read(file, layer, metres_from_stage, needs_mesh)?;
    let (mut surface, mut palette) = (Surface::default(), Palette::default());
    let mut shapes = BTreeMap::new();
    let mut meshes = 0;
    let mut hidden = HiddenMeshes::new(settings);
    let mut materials = Materials::default();
    if needs_mesh {
        let prims = layer.prims(&["Mesh"])?;
        materials = Materials::read(layer, files)?;
        meshes = prims.len();
        let mut worn = WornHair::new(settings);
        let mut parts = Vec::new();
        for (prim, _) in prims {
            let path = layer.path(prim);
            let names: Vec<&str> = path.rsplit('/').take(2).collect();
            worn.offer(&names);
            parts.push(prim);
        }
        for (prim, is_hair) in parts.into_iter().zip(worn.decide(&mut notes)) {
            if is_hair || !hidden.reads(mesh::hidden(layer, prim)?) {
                continue;
            }
            let mut reader = mesh::Reader {
                file,
                figure: &figure,
                surface: &mut surface,
                palette: &mut palette,
                shapes: &mut shapes,
                materials: &mut materials,
                dropped: &mut dropped,
            };
            reader.mesh(layer, prim, metres_from_stage)?;
        }
        hidden.note(&mut notes);
        note_curves(layer, &mut notes)?;
        match layer.undefined(&["Mesh"])? {
            0 => {}
            some => notes.push(format!(
                "{} not on the stage: inactive, a class, or an `over` of nothing",
                counted(some, "mesh is", "meshes are")
            )),
        }
    }
    let mut draft = Draft::with_surface(file, surface.finish(palette), materials.looks, notes);
    let animations = layer.prims(&["SkelAnimation"])?;
    if needs_mesh && draft.mesh.triangles.is_empty() {
        return Err(MotionError::Empty {
            file: file.to_owned(),
            found: format!(
                "{} without a usable triangle{}{}",
                counted(meshes, "mesh", "meshes"),
                hidden.in_error(),
                only_motion(animations.len())
            ),
            wanted: "a mesh of triangles",
        });
    }
    draft.clips = clip::read_clips(file, layer, &figure, &shapes)?;
    (draft.joints, draft.skins) = (figure.joints_of_skeletons(), figure.skeletons.len());
    (draft.skeleton, draft.dropped) = (figure.skeleton, dropped);
    let mut character = draft.finish(Axes { settings, usual_unit_metres: unit_metres })?;
    let form = match (is_package, is_crate) {
        (true, _) => "package",
        (false, true) => "binary",
        (false, false) => "text",
    };
    character.format = format!("USD ({form})");
    Ok(character)
}

/// Adds a note about the curves of a file that is read as a body.
fn note_curves(layer: &mut dyn Layer, notes: &mut Vec<String>) -> Result<(), MotionError> {
    let curves = layer.prims(&["BasisCurves"])?;
    let mut hidden = 0;
    for &(prim, _) in curves.iter().take(MAX_LOOKED_AT) {
        hidden += usize::from(mesh::hidden(layer, prim)?.is_some());
    }
    let drawn = curves.len() - hidden;
    if hidden > 0 {
        let what = "which the file hides or marks as guides";
        notes.push(format!("left out {}, {what}", counted(hidden, "prim of curves", "prims of curves")));
    }
    if drawn > 0 {
        notes.push(format!(
            "left out {}, which are hair",
            counted(drawn, "prim of curves", "prims of curves")
        ));
    }
    Ok(())
}

/// The matrix of USD, for row vectors, as a transform; `None` if it is not finite.
fn affine(rows: &[f64; 16]) -> Option<Affine3A> {
    // USD uses row vectors, so its rows are the columns here.
    let matrix = DMat4::from_cols_array(rows);
    matrix.is_finite().then(|| affine_of(&matrix))
}

fn affine_of(matrix: &DMat4) -> Affine3A {
    let matrix: Mat4 = matrix.as_mat4();
    Affine3A { matrix3: Mat3A::from_mat4(matrix), translation: matrix.w_axis.truncate().into() }
}

/// The tokens of an attribute; empty if it is missing.
fn tokens(layer: &mut dyn Layer, prim: usize, name: &str) -> Result<Vec<String>, UsdError> {
    Ok(layer.attribute(prim, name, MAX_NAMES)?.map_or_else(Vec::new, Value::into_tokens))
}

/// Most prims of curves whose visibility decides what a file is.
const MAX_LOOKED_AT: usize = 1000;

/// Most joints or shapes that one attribute may name.
const MAX_NAMES: usize = 1 << 16;

/// The first target of a relationship of a prim or of the nearest prim above it that has one.
fn inherited_target(layer: &mut dyn Layer, prim: usize, name: &str) -> Result<Option<usize>, UsdError> {
    let mut at = Some(prim);
    for _ in 0..256 {
        let Some(prim) = at else { break };
        if let Some(path) = layer.targets(prim, name)?.first() {
            return Ok(layer.prim_at(path));
        }
        at = layer.parent(prim);
    }
    Ok(None)
}
