//! Lines of glTF 2.0: primitives of the modes LINES, `LINE_LOOP` and `LINE_STRIP`, in the space of the scene.
//!
//! glTF states metres and Y up. Half of the width of hair is the attribute `_RADIUS`, a convention of several programs;
//! colours are `COLOR_0`. Skins, animations and morph targets do not apply to lines. Nodes of scale 0 are hidden.

mod data;
mod document;
mod write;

use std::fs::File as DiskFile;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use glam::{Mat4, Vec3};
use serde::Deserialize;

use super::HairFileError;
use super::chain::{Chains, chain};
use super::file::{MOST_COPIED_POINTS, RawHair};
use super::format::HairFormat;
use super::source::Source;
use super::units::{UpAxis, display_from_linear};
use data::{Data, File, split};
use document::{Document, Primitive};

/// `.glb`: one binary file.
pub(super) static BINARY: HairFormat = HairFormat {
    label: "glTF lines",
    extensions: &["glb"],
    signature: "`glTF` or a JSON document (glTF)",
    states_unit: true,
    common_up: UpAxis::Y,
    magics: &[MAGIC],
    may_begin: |_| false,
    read,
    write: Some(write::binary),
};

/// `.gltf`: a JSON document.
pub(super) static TEXT: HairFormat = HairFormat {
    label: "glTF lines",
    extensions: &["gltf"],
    signature: "`{` (glTF)",
    states_unit: true,
    common_up: UpAxis::Y,
    magics: &[],
    may_begin: |start| {
        start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start().starts_with(b"{")
    },
    read,
    write: Some(write::text),
};

/// The first bytes of a binary file.
const MAGIC: &[u8] = b"glTF";

const LINES: u32 = 1;
const LINE_LOOP: u32 = 2;
const LINE_STRIP: u32 = 3;
const TRIANGLES: u32 = 4;
const TRIANGLE_FAN: u32 = 6;

fn is_line(mode: Option<u32>) -> bool {
    matches!(mode, Some(LINES | LINE_LOOP | LINE_STRIP))
}

/// What a glTF file contains, by its document alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GltfContent {
    /// Whether there are lines, which are hair.
    pub lines: bool,
    /// Whether there are triangles, which are a body.
    pub triangles: bool,
    /// Number of animations.
    pub clips: usize,
}

/// What a glTF file, binary or text, contains; `None` for a file that cannot be read.
pub fn gltf_content(path: &Path) -> Option<GltfContent> {
    #[derive(Default, Deserialize)]
    #[serde(default)]
    struct Parts {
        meshes: Vec<Primitives>,
        animations: Vec<serde::de::IgnoredAny>,
    }
    #[derive(Deserialize)]
    struct Primitives {
        #[serde(default)]
        primitives: Vec<Mode>,
    }
    #[derive(Deserialize)]
    struct Mode {
        mode: Option<u32>,
    }
    let mut file = DiskFile::open(path).ok()?;
    let mut head = [0; 20];
    let read = file.read(&mut head).ok()?;
    let length = if head.starts_with(MAGIC) && read == 20 {
        u64::from(u32::from_le_bytes(*head[12..].first_chunk()?))
    } else {
        let mark = if head.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        file.seek(SeekFrom::Start(mark)).ok()?;
        u64::MAX
    };
    let parts: Parts = serde_json::from_reader(BufReader::with_capacity(1 << 16, file).take(length)).ok()?;
    let modes = || parts.meshes.iter().flat_map(|mesh| &mesh.primitives).map(|primitive| primitive.mode);
    Some(GltfContent {
        lines: modes().any(is_line),
        triangles: modes().any(|mode| (TRIANGLES..=TRIANGLE_FAN).contains(&mode.unwrap_or(TRIANGLES))),
        clips: parts.animations.len(),
    })
}

fn read(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let folder = source.folder();
    let bytes = source.into_bytes(name)?;
    let file = File { name };
    let (json, bin) = split(file, &bytes)?;
    let document: Document = serde_json::from_slice(json).map_err(|error| {
        let at = (json.as_ptr() as usize - bytes.as_ptr() as usize) as u64;
        file.malformed(at, format!("JSON that cannot be read: {error}"), "a glTF document")
    })?;
    for unknown in ["EXT_meshopt_compression", "KHR_draco_mesh_compression"] {
        if document.extensions_required.iter().any(|required| required == unknown) {
            return Err(file.malformed(0, format!("the extension {unknown}"), "a file without compression"));
        }
    }
    let data = Data::load(file, &document, bin, folder.as_deref())?;
    let mut lines = Lines {
        file,
        data,
        most_points: MOST_COPIED_POINTS.max(bytes.len()),
        raw: RawHair::new(Vec::new(), Vec::new()),
        widths: Some(Vec::new()),
        colours: Some(Vec::new()),
        surfaces: 0,
    };
    for (node, transform) in nodes(&document) {
        let mesh = document.nodes[node].mesh.and_then(|mesh| document.meshes.get(mesh));
        // A node of scale 0 hides what it carries, as in an animation of one mesh per frame.
        if transform.determinant().abs() > 1e-18 {
            for primitive in mesh.iter().flat_map(|mesh| &mesh.primitives) {
                lines.primitive(primitive, transform)?;
            }
        }
    }
    lines.finish()
}

/// The nodes of the default scene with their transforms, parents first. A node that is reached twice counts once.
fn nodes(document: &Document) -> Vec<(usize, Mat4)> {
    let is_child = || {
        let mut is_child = vec![false; document.nodes.len()];
        for &child in document.nodes.iter().flat_map(|node| &node.children) {
            if let Some(is_child) = is_child.get_mut(child) {
                *is_child = true;
            }
        }
        is_child
    };
    let roots = match document.scenes.get(document.scene.unwrap_or(0)) {
        Some(scene) => scene.nodes.clone(),
        None => {
            is_child().iter().enumerate().filter(|(_, is_child)| !**is_child).map(|(node, _)| node).collect()
        }
    };
    let mut seen = vec![false; document.nodes.len()];
    let mut open: Vec<(usize, Mat4)> = roots.into_iter().rev().map(|root| (root, Mat4::IDENTITY)).collect();
    let mut found = Vec::new();
    while let Some((node, parent)) = open.pop() {
        let (Some(seen), Some(content)) = (seen.get_mut(node), document.nodes.get(node)) else { continue };
        if std::mem::replace(seen, true) {
            continue;
        }
        let transform = parent * content.transform();
        found.push((node, transform));
        open.extend(content.children.iter().rev().map(|&child| (child, transform)));
    }
    found
}

/// The strands read so far.
struct Lines<'a> {
    file: File<'a>,
    data: Data<'a>,
    most_points: usize,
    raw: RawHair,
    /// Widths of all points, as long as every primitive has them.
    widths: Option<Vec<f32>>,
    colours: Option<Vec<[f32; 3]>>,
    /// Primitives that are no lines.
    surfaces: u64,
}

impl Lines<'_> {
    fn primitive(&mut self, primitive: &Primitive, transform: Mat4) -> Result<(), HairFileError> {
        if !is_line(primitive.mode) {
            self.surfaces += 1;
            return Ok(());
        }
        let Some(position) = primitive.attributes.position else { return Ok(()) };
        let positions = self.data.vectors(position, [0.0; 3])?;
        let chains = self.strands(primitive, &positions)?;
        if self.raw.points.len() + chains.vertices.len() > self.most_points {
            let found = "a scene that shows the same points again and again";
            return Err(self.file.malformed(0, found, format!("{} points at most", self.most_points)));
        }
        let scale = transform.determinant().abs().cbrt();
        let same_length = |what: &str, length: usize| {
            if length == positions.len() {
                return Ok(());
            }
            let found = format!("{length} values of {what} for {} points", positions.len());
            Err(self.file.malformed(0, found, "one per point"))
        };
        match (primitive.attributes.radius, &mut self.widths) {
            (Some(radius), Some(widths)) => {
                let radii = self.data.vectors(radius, [0.0])?;
                same_length("_RADIUS", radii.len())?;
                widths.extend(chains.vertices.iter().map(|&v| 2.0 * radii[v as usize][0] * scale));
            }
            _ => self.widths = None,
        }
        match (primitive.attributes.color, &mut self.colours) {
            (Some(color), Some(colours)) => {
                let linear = self.data.vectors(color, [1.0; 3])?;
                same_length("COLOR_0", linear.len())?;
                colours.extend(chains.vertices.iter().map(|&v| linear[v as usize].map(display_from_linear)));
            }
            _ => self.colours = None,
        }
        self.raw.points.extend(
            chains.vertices.iter().map(|&v| transform.transform_point3(Vec3::from(positions[v as usize]))),
        );
        self.raw.point_counts.extend(chains.counts);
        Ok(())
    }

    /// The strands of a primitive as sequences of its vertices.
    fn strands(&self, primitive: &Primitive, positions: &[[f32; 3]]) -> Result<Chains, HairFileError> {
        let points = positions.len();
        let listed = match primitive.indices {
            Some(indices) => Some(self.data.indices(indices, points as u64)?),
            None => None,
        };
        if primitive.mode != Some(LINES) {
            let mut vertices = listed.unwrap_or_else(|| (0..points as u32).collect());
            if primitive.mode == Some(LINE_LOOP) {
                vertices.extend(vertices.first().copied());
            }
            return Ok(Chains { counts: vec![vertices.len() as u32], vertices, first_listed: vec![0] });
        }
        if let Some(listed) = listed {
            return Ok(chain(listed.as_chunks::<2>().0, points));
        }
        // Without indices a segment that begins where the one before ends continues its strand.
        let mut segments: Vec<[u32; 2]> = Vec::with_capacity(points / 2);
        for first in (0..points as u32 / 2).map(|pair| 2 * pair) {
            let end = segments.last().map(|&[_, end]| end);
            let joined = end.filter(|&end| positions[end as usize] == positions[first as usize]);
            segments.push([joined.unwrap_or(first), first + 1]);
        }
        Ok(chain(&segments, points))
    }

    fn finish(mut self) -> Result<RawHair, HairFileError> {
        if self.raw.point_counts.is_empty() {
            let found = format!("no lines, and {} primitives of other modes", self.surfaces);
            return Err(self.file.malformed(
                0,
                found,
                "primitives of the mode LINES, LINE_LOOP or LINE_STRIP",
            ));
        }
        if self.surfaces > 0 {
            let note = format!(
                "{} meshes of points or triangles were left out: only lines are hair.",
                self.surfaces
            );
            self.raw.notes.push(note);
        }
        self.raw.thickness = self.widths;
        self.raw.colours = self.colours;
        Ok(self.raw)
    }
}

#[cfg(test)]
mod tests;
