//! Characters and clips from FBX files, binary or text, by the library ufbx.
//!
//! The library converts units and axes, resolves pivots, pre-rotations and scale compensation into plain transforms of nodes, and
//! turns curves of Euler angles into keys of quaternions.

mod clip;
mod material;
mod mesh;
mod nodes;
mod rest;
mod visible;

use std::path::Path;

use glam::{Affine3A, Quat, Vec3};
use lovelock_base::watch::{Cancelled, Watch};
use lovelock_base::words::counted;
use ufbx::{
    AllocatorOpts, CoordinateAxes, CoordinateAxis, ErrorType, GeometryTransformHandling, InheritModeHandling,
    LoadOpts, ProgressCb, ProgressResult, Scene, SpaceConversion,
};

use crate::character::{Axes, Character, Draft, HiddenMeshes, only_motion};
use crate::content::FigureContent;
use crate::surface::{Palette, Surface};
use crate::{BodySettings, MotionError};

/// Deepest tree of nodes that is read; characters have about 30 levels.
const DEPTH_LIMIT: u32 = 1000;

/// Whether a file is FBX, by its first bytes.
pub fn is_fbx(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(4096)];
    let holds = |word: &[u8]| start.windows(word.len()).any(|window| window == word);
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
    start.starts_with(b"Kaydara FBX Binary")
        || text.starts_with(b"; FBX")
        || ((text.starts_with(b";") || text.starts_with(b"FBXHeaderExtension"))
            && holds(b"FBXHeaderExtension"))
}

/// Reads an FBX file. Without `needs_mesh` a file without a body, such as a clip alone, is read too, and meshes are left out.
pub(crate) fn read(
    (file, watch): (&str, &Watch),
    bytes: &[u8],
    folder: Option<&Path>,
    settings: BodySettings,
    needs_mesh: bool,
) -> Result<Character, MotionError> {
    let mut cancelled = false;
    let mut progress = |at: &ufbx::Progress| {
        cancelled = watch.at(at.bytes_read as f32 / at.bytes_total.max(1) as f32).is_err();
        if cancelled { ProgressResult::Cancel } else { ProgressResult::Continue }
    };
    let loaded = ufbx::load_memory(
        bytes,
        LoadOpts { progress_cb: ProgressCb::Mut(&mut progress), ..options(bytes.len(), needs_mesh) },
    );
    let scene = match loaded {
        Ok(scene) => scene,
        Err(_) if cancelled => {
            return Err(MotionError::Read { file: file.to_owned(), source: Cancelled.into() });
        }
        Err(error) => return Err(refuse(file, bytes, &error)),
    };
    let mut notes = warnings(&scene);
    let mut dropped = std::collections::BTreeMap::new();
    let nodes = nodes::Nodes::new(file, &scene, needs_mesh)?;
    let mut surface = Surface::default();
    let mut palette = Palette::default();
    let mut morphs = mesh::MorphsOfChannels::new();
    let mut hidden = HiddenMeshes::new(settings);
    let mut materials = material::Materials::new(folder);
    if needs_mesh {
        let read = mesh::Reader {
            file,
            nodes: &nodes,
            surface: &mut surface,
            palette: &mut palette,
            morphs: &mut morphs,
            materials: &mut materials,
            dropped: &mut dropped,
        };
        read.all(&scene, settings, &mut hidden, &mut notes)?;
        hidden.note(&mut notes);
    }
    let mut draft = Draft::with_surface(file, surface.finish(palette), materials.looks, notes);
    if needs_mesh && draft.mesh.triangles.is_empty() {
        return Err(MotionError::Empty {
            file: file.to_owned(),
            found: describe(&scene, bytes) + &hidden.in_error() + only_motion(scene.anim_stacks.len()),
            wanted: "a mesh of triangles",
        });
    }
    draft.clips = clip::read_clips(&scene, &nodes, &morphs, &mut draft.notes);
    let metadata = &scene.metadata;
    let format = format!(
        "FBX {}.{} ({})",
        metadata.version / 1000,
        metadata.version / 100 % 10,
        if metadata.ascii { "text" } else { "binary" }
    );
    let stated = scene.settings.original_unit_meters;
    let usual_unit_metres = if stated.is_finite() && stated > 0.0 { stated as f32 } else { 0.01 };
    (draft.joints, draft.skins) = (nodes.joints_of_skins(&scene), scene.skin_deformers.len());
    draft.skeleton = nodes.skeleton().clone();
    if !needs_mesh {
        draft.notes.extend(rest::choose(&scene, &nodes, &mut draft.skeleton, &draft.clips));
    }
    draft.dropped = dropped;
    let mut character = draft.finish(Axes { settings, usual_unit_metres })?;
    character.format = format;
    Ok(character)
}

/// What a file contains, without its geometry.
pub(crate) fn content(file: &str, bytes: &[u8]) -> Result<FigureContent, MotionError> {
    let scene = ufbx::load_memory(bytes, options(bytes.len(), false)).map_err(|e| refuse(file, bytes, &e))?;
    Ok(if !scene.meshes.is_empty() {
        FigureContent::Body
    } else if !scene.anim_curves.is_empty() {
        FigureContent::Clip
    } else {
        FigureContent::Nothing
    })
}

fn options<'a>(file_bytes: usize, needs_mesh: bool) -> LoadOpts<'a> {
    // Arrays are compressed, and numbers are widened to 64 bits.
    let memory_limit = file_bytes.saturating_mul(60).saturating_add(256 << 20);
    let allocator = || AllocatorOpts { memory_limit, ..AllocatorOpts::default() };
    LoadOpts {
        temp_allocator: allocator(),
        result_allocator: allocator(),
        ignore_geometry: !needs_mesh,
        ignore_embedded: !needs_mesh,
        node_depth_limit: DEPTH_LIMIT,
        clean_skin_weights: true,
        geometry_transform_handling: GeometryTransformHandling::ModifyGeometry,
        inherit_mode_handling: InheritModeHandling::Compensate,
        space_conversion: SpaceConversion::ModifyGeometry,
        target_axes: CoordinateAxes {
            right: CoordinateAxis::PositiveX,
            up: CoordinateAxis::PositiveY,
            front: CoordinateAxis::PositiveZ,
        },
        target_unit_meters: 1.0,
        ..LoadOpts::default()
    }
}

/// The library's error as a sentence.
fn refuse(file: &str, bytes: &[u8], error: &ufbx::Error) -> MotionError {
    let description: &str = &error.description;
    let problem = match error.type_ {
        ErrorType::UnsupportedVersion => {
            // A binary file states its version after its signature.
            let stated = bytes.get(23..).and_then(|rest| rest.first_chunk::<4>());
            let stated = stated.filter(|_| bytes.starts_with(b"Kaydara FBX Binary"));
            let version = stated.map_or_else(String::new, |four| format!(" ({})", u32::from_le_bytes(*four)));
            format!(
                "has a version{version} that is not read; export it as FBX 2011 to 2020 (versions 7100 to 7700)"
            )
        }
        _ if is_cut(bytes) => "ends too early: it was cut off; copy or export it again".to_owned(),
        ErrorType::TruncatedFile => "ends too early: it was cut off; copy or export it again".to_owned(),
        ErrorType::MemoryLimit | ErrorType::AllocationLimit => {
            "unpacks to more than 60 times its size; export it again".to_owned()
        }
        ErrorType::NodeDepthLimit => format!("has nodes deeper than {DEPTH_LIMIT} levels"),
        ErrorType::UnrecognizedFileFormat | ErrorType::EmptyFile => {
            "holds no FBX document after its signature".to_owned()
        }
        _ => format!(
            "is damaged ({}); must be FBX of version 6 or 7, binary or text",
            description.to_lowercase()
        ),
    };
    MotionError::malformed(file, "the file", problem)
}

/// Whether a binary file ends within one of its outermost records, which state where they end.
fn is_cut(bytes: &[u8]) -> bool {
    let number = |at: usize, size: usize| -> Option<u64> {
        let bytes = bytes.get(at..at.checked_add(size)?)?;
        Some(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    };
    let Some(version) = number(23, 4).filter(|_| bytes.starts_with(b"Kaydara FBX Binary")) else {
        return false;
    };
    let size = if version >= 7500 { 8 } else { 4 };
    let mut at = 27;
    loop {
        match number(at, size).map(|end| usize::try_from(end).unwrap_or(usize::MAX)) {
            Some(0) => return false,
            // Not a position after this one: damage of another kind.
            Some(end) if end <= at => return false,
            Some(end) if end <= bytes.len() => at = end,
            _ => return true,
        }
    }
}

/// What the library corrected, as remarks.
fn warnings(scene: &Scene) -> Vec<String> {
    let mut notes = Vec::new();
    for warning in &scene.metadata.warnings {
        let note = format!("FBX: {}", &*warning.description);
        if notes.len() < 8 && !notes.contains(&note) {
            notes.push(note);
        }
    }
    notes
}

/// What a file without triangles contains.
fn describe(scene: &Scene, bytes: &[u8]) -> String {
    let encrypted = b"EncryptionType";
    // The value follows the name: a letter and an integer in binary files, `: 1` in text.
    let at = bytes.windows(encrypted.len()).position(|window| window == encrypted);
    let value = at.map(|at| &bytes[at + encrypted.len()..]).and_then(|rest| match rest {
        [b'I' | b'L' | b'Y', low, ..] => Some(*low),
        [b':', text @ ..] => text.trim_ascii_start().first().map(|digit| digit.wrapping_sub(b'0')),
        _ => None,
    });
    if value.is_some_and(|value| value != 0) {
        return "an encrypted document".to_owned();
    }
    let nodes = counted(scene.nodes.len(), "node", "nodes");
    let meshes = counted(scene.meshes.len(), "mesh", "meshes");
    format!("{nodes} and {meshes} without a usable triangle")
}

fn vec3(v: ufbx::Vec3) -> Vec3 {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}

/// A rotation of unit length; the identity if it has no length.
fn quat(q: ufbx::Quat) -> Quat {
    let q = Quat::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32);
    let length = q.length();
    if length.is_finite() && length > 1e-6 { q * (1.0 / length) } else { Quat::IDENTITY }
}

fn affine(m: &ufbx::Matrix) -> Affine3A {
    let column = |x: f64, y: f64, z: f64| Vec3::new(x as f32, y as f32, z as f32);
    Affine3A {
        matrix3: glam::Mat3A::from_cols(
            column(m.m00, m.m10, m.m20).into(),
            column(m.m01, m.m11, m.m21).into(),
            column(m.m02, m.m12, m.m22).into(),
        ),
        translation: column(m.m03, m.m13, m.m23).into(),
    }
}
