//! Curves that follow the hair from frame to frame, with the body beside them, for other programs: USD and glTF.
//!
//! [`CurveWriter`] takes one [`CurveFrame`] after the other. They wait in an unnamed file beside the output, as both
//! formats want all times of one thing together; memory holds one frame, and at the end one array of the file.

mod crate_tail;
mod glb;
mod layer;
mod spool;
mod usd;

use std::path::Path;

use glam::{Affine3A, Vec3};

use crate::partial::{Opener, create_parent, open_file};
use crate::{FrameRate, RecordError};
use glb::GlbWriter;
use usd::UsdWriter;

/// A format of curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveFormat {
    /// USD as text: `.usda`.
    Usda,
    /// USD as a binary crate: `.usdc`, `.usd`.
    Usdc,
    /// glTF 2 in one file: `.glb`.
    Glb,
}

impl CurveFormat {
    /// Endings of such files, without the dot.
    pub const EXTENSIONS: [&str; 4] = ["usdc", "usd", "usda", "glb"];

    /// The format that a name asks for by its ending, in any case; none for other names.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "usda" => Some(Self::Usda),
            "usdc" | "usd" => Some(Self::Usdc),
            "glb" => Some(Self::Glb),
            _ => None,
        }
    }

    /// Stable name for reports.
    pub fn id(self) -> &'static str {
        match self {
            Self::Usda => "usda",
            Self::Usdc => "usdc",
            Self::Glb => "glb",
        }
    }
}

/// What stays the same from frame to frame. World space is metres, right-handed, Y up.
#[derive(Clone, Debug)]
pub struct CurveScene {
    /// Frames a second.
    pub rate: FrameRate,
    /// Number of the first frame: its time code.
    pub first_frame: u64,
    /// Frames that will come, 1 or more.
    pub frames: u64,
    /// Index of the first point of each curve, with the number of points at the end (curves + 1).
    pub first_point: Vec<u32>,
    /// Full width of each point, metres.
    pub widths: Vec<f32>,
    /// Colour of each point, linear sRGB.
    pub colors: Vec<Vec3>,
    /// The body, where it goes with the hair.
    pub body: Option<CurveBody>,
}

/// The surface of the body, one entry a vertex unless said otherwise.
#[derive(Clone, Debug, Default)]
pub struct CurveBody {
    /// Counter-clockwise triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Colours, linear sRGB.
    pub colors: Vec<Vec3>,
    /// Positions as they are bound to the joints, metres.
    pub bind_positions: Vec<Vec3>,
    /// Unit normals as they are bound to the joints.
    pub bind_normals: Vec<Vec3>,
    /// Entries of `joint_from_bind` that move each vertex, heaviest first.
    pub joints: Vec<[u16; 8]>,
    /// Their weights, which sum to 1.
    pub weights: Vec<[f32; 8]>,
    /// Carries bind space into each joint's space; one entry a joint.
    pub joint_from_bind: Vec<Affine3A>,
}

/// One frame, world space, metres.
#[derive(Clone, Copy, Debug)]
pub struct CurveFrame<'a> {
    /// Coordinates of the curves' points: x, y and z.
    pub points: [&'a [f32]; 3],
    /// Where the body is; wanted where the scene has one.
    pub body: Option<BodyFrame<'a>>,
}

/// The body in one frame.
#[derive(Clone, Copy, Debug)]
pub struct BodyFrame<'a> {
    /// Positions of the vertices.
    pub positions: &'a [Vec3],
    /// Their unit normals.
    pub normals: &'a [Vec3],
    /// Transform of each joint to the world, in the order of `joint_from_bind`.
    pub joints: &'a [Affine3A],
}

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CurveReport {
    /// Frames.
    pub frames: u64,
    /// Length of the file, bytes.
    pub bytes: u64,
}

impl CurveScene {
    /// Points of all curves.
    pub fn points(&self) -> usize {
        self.first_point.last().map_or(0, |&end| end as usize)
    }

    /// Number of curves.
    pub fn curves(&self) -> usize {
        self.first_point.len().saturating_sub(1)
    }

    /// Points of each curve.
    pub fn counts(&self) -> impl Iterator<Item = u32> + '_ {
        self.first_point.array_windows().map(|[a, b]| b - a)
    }

    fn check(&self, path: &Path, format: CurveFormat) -> Result<(), RecordError> {
        let refuse = |what: &str| Err(RecordError::request(format!("{}: {what}", path.display())));
        let points = self.points();
        if self.frames == 0 {
            return refuse("no frame to write; wanted one or more");
        }
        let body_fits = self.body.as_ref().is_none_or(|body| {
            let vertices = body.bind_positions.len();
            [body.colors.len(), body.bind_normals.len(), body.joints.len(), body.weights.len()]
                .iter()
                .all(|&length| length == vertices)
                && body.triangles.as_flattened().iter().all(|&vertex| (vertex as usize) < vertices)
                && body
                    .joints
                    .as_flattened()
                    .iter()
                    .all(|&joint| usize::from(joint) < body.joint_from_bind.len().max(1))
        });
        if points == 0 || self.first_point.array_windows().any(|[a, b]| a.saturating_add(2) > *b) {
            return refuse("no curves of two points or more");
        }
        if self.widths.len() != points || self.colors.len() != points || !body_fits {
            return refuse("curves or a body whose arrays differ in length");
        }
        self.check_size(path, format)
    }

    /// Refuses what no disk or program would take, before anything is written.
    fn check_size(&self, path: &Path, format: CurveFormat) -> Result<(), RecordError> {
        let refuse = |bytes: u64, most: u64, instead: &str| {
            Err(RecordError::request(format!(
                "{}: {} frames of {} points would be about {:.1} GB, and {:.1} GB is the most: {instead}",
                path.display(),
                self.frames,
                self.points(),
                bytes as f64 / 1e9,
                most as f64 / 1e9,
            )))
        };
        let most_frames = if format == CurveFormat::Glb { MOST_GLB_FRAMES } else { MOST_FRAMES };
        if self.frames > most_frames {
            return Err(RecordError::request(format!(
                "{}: {} frames, and {most_frames} are the most: write them in parts, with --frames",
                path.display(),
                self.frames
            )));
        }
        let vertices = self.body.as_ref().map_or(0, |body| body.bind_positions.len() as u64);
        let points = self.points() as u64;
        let bytes = |size: u64, count: u64| self.frames.saturating_mul(count).saturating_mul(size);
        match format {
            CurveFormat::Usda => {
                // Measured: 63 to 68 bytes for a point as text.
                let bytes = bytes(68, points + 2 * vertices);
                if bytes > MOST_TEXT {
                    return refuse(
                        bytes,
                        MOST_TEXT,
                        "write .usdc, the guides (--curves guides), or fewer frames",
                    );
                }
            }
            CurveFormat::Usdc => {
                let bytes = bytes(12, vertices);
                if bytes > MOST_ARRAY {
                    return refuse(
                        bytes,
                        MOST_ARRAY,
                        "write fewer frames, or leave the body out (--no-body)",
                    );
                }
            }
            CurveFormat::Glb => {
                let bytes = bytes(12, points).saturating_add(64 * points + 128 * vertices);
                if bytes > MOST_GLB {
                    return refuse(
                        bytes,
                        MOST_GLB,
                        "write the guides (--curves guides), fewer frames, or .usdc",
                    );
                }
            }
        }
        Ok(())
    }
}

/// The most frames: their times and boxes are held in memory.
const MOST_FRAMES: u64 = 1 << 20;
/// The most frames of a glTF, which has a node and a mesh for each in its description.
const MOST_GLB_FRAMES: u64 = 1 << 16;
/// The most bytes of text: more is no file that a program would open.
const MOST_TEXT: u64 = 8 << 30;
/// The most bytes of one array with all its times, which is held in memory while it is written.
const MOST_ARRAY: u64 = 2 << 30;
/// The most bytes of a binary glTF, whose lengths have 32 bits.
const MOST_GLB: u64 = (1 << 32) - (64 << 20);

/// Writes curves frame by frame. Dropping it without [`CurveWriter::finish`] is a cancel, and leaves nothing.
pub struct CurveWriter(Writer);

enum Writer {
    Usd(UsdWriter),
    Glb(GlbWriter),
}

impl std::fmt::Debug for CurveWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("CurveWriter").finish_non_exhaustive()
    }
}

impl CurveWriter {
    /// Begins a file in the format that its name asks for.
    ///
    /// # Errors
    /// A name with another ending, a scene whose arrays do not fit together or that would be too large a file, and
    /// folders or files that cannot be made.
    pub fn create(path: &Path, scene: CurveScene) -> Result<Self, RecordError> {
        Self::create_with(path, scene, &open_file)
    }

    fn create_with(path: &Path, scene: CurveScene, opener: &Opener) -> Result<Self, RecordError> {
        let format = CurveFormat::of(path).ok_or_else(|| {
            RecordError::request(format!(
                "{}: no format of curves: wanted a name ending in .usda, .usdc, .usd or .glb",
                path.display()
            ))
        })?;
        scene.check(path, format)?;
        create_parent(path).map_err(|error| RecordError::io(path, "make its folder", error))?;
        Ok(Self(match format {
            CurveFormat::Usda | CurveFormat::Usdc => {
                Writer::Usd(UsdWriter::create(path, scene, format == CurveFormat::Usda, opener)?)
            }
            CurveFormat::Glb => Writer::Glb(GlbWriter::create(path, scene, opener)?),
        }))
    }

    /// Takes the next frame.
    ///
    /// # Errors
    /// A frame of other lengths than the scene's, one too many, or a disk that takes no more.
    pub fn push(&mut self, frame: &CurveFrame<'_>) -> Result<(), RecordError> {
        match &mut self.0 {
            Writer::Usd(writer) => writer.push(frame),
            Writer::Glb(writer) => writer.push(frame),
        }
    }

    /// Writes the file and gives it its name.
    ///
    /// # Errors
    /// Fewer frames than were said, or a disk that takes no more; nothing is left of the file then.
    pub fn finish(self) -> Result<CurveReport, RecordError> {
        match self.0 {
            Writer::Usd(writer) => writer.finish(),
            Writer::Glb(writer) => writer.finish(),
        }
    }
}

#[cfg(test)]
mod tests;
