//! Export of the animated hair and body as USD, glTF or Alembic curves.
//!
//! [`CurveWriter`] receives one [`CurveFrame`] after another. Alembic takes them as they come. USD and glTF keep all times of
//! an array together, so frames are first stored in an unnamed file in the output's folder. Memory holds one frame and, at the
//! end, one array of the file.

mod abc;
mod crate_tail;
mod expected;
mod glb;
mod gltf_look;
mod gltf_morphs;
mod layer;
mod look;
mod spool;
mod usd;
mod usd_look;

use std::path::Path;
use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};
use lovelock_groom::StrandMarks;
use lovelock_motion::{Image, Material, MorphTarget};

use crate::partial::{Opener, create_parent, open_file};
use crate::{FrameRate, RecordError};
use abc::AbcWriter;
use glb::GlbWriter;
use usd::UsdWriter;

/// A file format for curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveFormat {
    /// USD as text: `.usda`.
    Usda,
    /// USD as a binary crate: `.usdc`, `.usd`.
    Usdc,
    /// glTF 2 in one file: `.glb`.
    Glb,
    /// Alembic in the Ogawa form: `.abc`.
    Abc,
}

impl CurveFormat {
    /// File extensions of the formats, without the dot.
    pub const EXTENSIONS: [&str; 5] = ["usdc", "usd", "usda", "glb", "abc"];

    /// The format for the extension of a name, in upper or lower case; none for other extensions.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "usda" => Some(Self::Usda),
            "usdc" | "usd" => Some(Self::Usdc),
            "glb" => Some(Self::Glb),
            "abc" => Some(Self::Abc),
            _ => None,
        }
    }

    /// Stable name for reports.
    pub fn id(self) -> &'static str {
        match self {
            Self::Usda => "usda",
            Self::Usdc => "usdc",
            Self::Glb => "glb",
            Self::Abc => "abc",
        }
    }
}

/// Everything that does not change from frame to frame. World space is right-handed, in metres, with Y up.
#[derive(Clone, Debug)]
pub struct CurveScene {
    /// Frames per second.
    pub rate: FrameRate,
    /// Number of the first frame, which is its time code.
    pub first_frame: u64,
    /// Number of frames, 1 or more.
    pub frames: u64,
    /// Index of the first point of each curve, and at the end the number of points (curves + 1 entries).
    pub first_point: Vec<u32>,
    /// Diameter at each point, in metres.
    pub widths: Vec<f32>,
    /// Colour of each point, linear sRGB.
    pub colors: Vec<Vec3>,
    /// Whether the curves are guides, which stand for several strands each.
    pub are_guides: bool,
    /// The groups of the curves, and the places of their roots on a surface, where they are known. glTF has no place for them.
    pub marks: StrandMarks,
    /// The body, if it is exported.
    pub body: Option<CurveBody>,
}

/// The surface of the body. Fields have one entry per vertex unless stated otherwise.
#[derive(Clone, Debug, Default)]
pub struct CurveBody {
    /// Counter-clockwise triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Colours, linear sRGB.
    pub colors: Vec<Vec3>,
    /// Opacity; empty if all are 1.
    pub opacity: Vec<f32>,
    /// Two sets of texture coordinates as in glTF; each may be empty.
    pub coordinates: [Vec<Vec2>; 2],
    /// How parts of the surface look.
    pub materials: Vec<Material>,
    /// Index into `materials` of each triangle; empty if all have the default material.
    pub of_triangles: Vec<u16>,
    /// The images that materials use.
    pub images: Arc<[Image]>,
    /// Positions in the bind pose without morph targets, in metres.
    pub bind_positions: Vec<Vec3>,
    /// Unit normals in the bind pose.
    pub bind_normals: Vec<Vec3>,
    /// Indices into `joint_from_bind` of the joints that move each vertex, largest weight first.
    pub joints: Vec<[u16; 8]>,
    /// Weights of these joints, which sum to 1.
    pub weights: Vec<[f32; 8]>,
    /// Transform from bind space to the space of each joint, one entry per joint.
    pub joint_from_bind: Vec<Affine3A>,
    /// Morph targets, which move the bind pose.
    pub morphs: Vec<MorphTarget>,
}

/// One frame in world space, in metres.
#[derive(Clone, Copy, Debug)]
pub struct CurveFrame<'a> {
    /// Coordinates of the curves' points: x, y and z.
    pub points: [&'a [f32]; 3],
    /// The body; required if the scene has one.
    pub body: Option<BodyFrame<'a>>,
}

/// The body in one frame.
#[derive(Clone, Copy, Debug)]
pub struct BodyFrame<'a> {
    /// Positions of the vertices.
    pub positions: &'a [Vec3],
    /// Unit normals of the vertices.
    pub normals: &'a [Vec3],
    /// Transform from each joint to the world, in the order of `joint_from_bind`.
    pub joints: &'a [Affine3A],
    /// Weights of the morph targets; those that are missing are 0.
    pub morph_weights: &'a [f32],
}

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CurveReport {
    /// Number of frames.
    pub frames: u64,
    /// Length of the file in bytes.
    pub bytes: u64,
}

impl CurveScene {
    /// Total number of points.
    pub fn points(&self) -> usize {
        self.first_point.last().map_or(0, |&end| end as usize)
    }

    /// Number of curves.
    pub fn curves(&self) -> usize {
        self.first_point.len().saturating_sub(1)
    }

    /// Number of points of each curve.
    pub fn counts(&self) -> impl Iterator<Item = u32> + '_ {
        self.first_point.array_windows().map(|[a, b]| b - a)
    }

    fn check(&self, path: &Path, format: CurveFormat) -> Result<(), RecordError> {
        let refuse = |what: &str| Err(RecordError::request(format!("{}: {what}", path.display())));
        let points = self.points();
        if self.frames == 0 {
            return refuse("no frames to write; must be at least one");
        }
        let body_fits = self.body.as_ref().is_none_or(|body| {
            let vertices = body.bind_positions.len();
            [body.colors.len(), body.bind_normals.len(), body.joints.len(), body.weights.len()]
                .iter()
                .all(|&length| length == vertices)
                && body.look_fits()
                && body.triangles.as_flattened().iter().all(|&vertex| (vertex as usize) < vertices)
                && body
                    .joints
                    .as_flattened()
                    .iter()
                    .all(|&joint| usize::from(joint) < body.joint_from_bind.len().max(1))
        });
        if points == 0 || self.first_point.array_windows().any(|[a, b]| a.saturating_add(2) > *b) {
            return refuse("no curves, or a curve with fewer than two points");
        }
        if self.widths.len() != points || self.colors.len() != points || !body_fits {
            return refuse("the arrays of the curves or of the body differ in length");
        }
        let fits = |length: usize| length == 0 || length == self.curves();
        if !fits(self.marks.groups.len()) || !fits(self.marks.root_uvs.len()) {
            return refuse("the groups or the roots of the curves differ in number from them");
        }
        self.check_size(path, format)
    }

    /// Checks the size of the file before anything is written.
    fn check_size(&self, path: &Path, format: CurveFormat) -> Result<(), RecordError> {
        let refuse = |bytes: u64, most: u64, instead: &str| {
            Err(RecordError::request(format!(
                "{}: {} frames of {} points would take about {:.1} GB; must be at most {:.1} GB: {instead}",
                path.display(),
                self.frames,
                self.points(),
                bytes as f64 / 1e9,
                most as f64 / 1e9,
            )))
        };
        let most_frames = if format == CurveFormat::Glb { MAX_GLB_FRAMES } else { MAX_FRAMES };
        if self.frames > most_frames {
            return Err(RecordError::request(format!(
                "{}: {} frames; must be at most {most_frames}: write them in parts, with --frames",
                path.display(),
                self.frames
            )));
        }
        let vertices = self.body.as_ref().map_or(0, |body| body.bind_positions.len() as u64);
        let points = self.points() as u64;
        let bytes = |size: u64, count: u64| self.frames.saturating_mul(count).saturating_mul(size);
        match format {
            CurveFormat::Usda => {
                // Measured: a point takes 63 to 68 bytes as text.
                let bytes = bytes(68, points + 2 * vertices);
                if bytes > MAX_TEXT {
                    return refuse(
                        bytes,
                        MAX_TEXT,
                        "write .usdc, the guides (--curves guides), or fewer frames",
                    );
                }
            }
            CurveFormat::Usdc => {
                let bytes = bytes(12, vertices);
                if bytes > MAX_ARRAY {
                    return refuse(bytes, MAX_ARRAY, "write fewer frames, or leave the body out (--no-body)");
                }
            }
            // Samples are written apart, each with a length of 64 bits.
            CurveFormat::Abc => {}
            CurveFormat::Glb => {
                let morphs = self.body.as_ref().map_or(&[][..], |body| &body.morphs);
                let moved: u64 = morphs.iter().map(|morph| morph.vertices.len() as u64).sum();
                let bytes = bytes(12, points)
                    .saturating_add(bytes(4, morphs.len() as u64))
                    .saturating_add(64 * points + 128 * vertices + 28 * moved);
                if bytes > MAX_GLB {
                    return refuse(
                        bytes,
                        MAX_GLB,
                        "write the guides (--curves guides), fewer frames, or .usdc",
                    );
                }
            }
        }
        Ok(())
    }
}

/// The most frames. Their times and bounding boxes are in memory.
const MAX_FRAMES: u64 = 1 << 20;
/// The most frames of a glTF, whose document has a node and a mesh for each.
const MAX_GLB_FRAMES: u64 = 1 << 16;
/// The most bytes of a text file. Hardly any program opens larger ones.
const MAX_TEXT: u64 = 8 << 30;
/// The most bytes of one array with all its times, which is in memory while it is written.
const MAX_ARRAY: u64 = 2 << 30;
/// The most bytes of a binary glTF, whose lengths have 32 bits.
const MAX_GLB: u64 = (1 << 32) - (64 << 20);

/// Writes curves frame by frame. If it is dropped without [`CurveWriter::finish`], the export is cancelled and its file removed.
pub struct CurveWriter(Writer);

enum Writer {
    Usd(UsdWriter),
    Glb(GlbWriter),
    Abc(Box<AbcWriter>),
}

impl std::fmt::Debug for CurveWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CurveWriter").finish_non_exhaustive()
    }
}

impl CurveWriter {
    /// Starts a file. Its format follows from its extension.
    ///
    /// # Errors
    /// For an unknown extension, for a scene whose arrays do not match or whose file would be too large, and for folders or
    /// files that cannot be created.
    pub fn create(path: &Path, scene: CurveScene) -> Result<Self, RecordError> {
        Self::create_with(path, scene, &open_file)
    }

    fn create_with(path: &Path, scene: CurveScene, opener: &Opener) -> Result<Self, RecordError> {
        let format = CurveFormat::of(path).ok_or_else(|| {
            RecordError::request(format!(
                "{}: unknown format of curves: the name must end in .usda, .usdc, .usd, .glb or .abc",
                path.display()
            ))
        })?;
        scene.check(path, format)?;
        create_parent(path).map_err(|error| RecordError::io(path, "create its folder", error))?;
        Ok(Self(match format {
            CurveFormat::Usda | CurveFormat::Usdc => {
                Writer::Usd(UsdWriter::create(path, scene, format == CurveFormat::Usda, opener)?)
            }
            CurveFormat::Glb => Writer::Glb(GlbWriter::create(path, scene, opener)?),
            CurveFormat::Abc => Writer::Abc(Box::new(AbcWriter::create(path, scene, opener)?)),
        }))
    }

    /// Writes the next frame.
    ///
    /// # Errors
    /// For a frame whose arrays do not match the scene, for a frame too many, and for a full disk.
    pub fn push(&mut self, frame: &CurveFrame<'_>) -> Result<(), RecordError> {
        match &mut self.0 {
            Writer::Usd(writer) => writer.push(frame),
            Writer::Glb(writer) => writer.push(frame),
            Writer::Abc(writer) => writer.push(frame),
        }
    }

    /// Completes the file and renames it to its final name.
    ///
    /// # Errors
    /// For fewer frames than the scene says, and for a full disk. The unfinished file is then removed.
    pub fn finish(self) -> Result<CurveReport, RecordError> {
        match self.0 {
            Writer::Usd(writer) => writer.finish(),
            Writer::Glb(writer) => writer.finish(),
            Writer::Abc(writer) => writer.finish(),
        }
    }
}

#[cfg(test)]
mod tests;
