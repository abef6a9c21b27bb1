//! Lines of glTF 2.0: primitives of the modes LINES, `LINE_LOOP` and `LINE_STRIP`, in the space of the scene.
//!
//! glTF states metres and Y up. Half of the width of hair is the attribute `_RADIUS`, a convention of several programs;
//! colours are `COLOR_0` times the base colour of the material. Skins, animations and morph targets do not apply to lines. Nodes of scale 0 hide what is below
//! them, as does `KHR_node_visibility`.

mod shared;
mod write;

use lovelock_base::words::counted;
use std::fs::File as DiskFile;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use glam::{Mat4, Vec3};
use lovelock_gltf::document::{Document, Mesh, Node, Primitive, Scene};
use lovelock_gltf::{Accessors, Asset, GltfError, MAGIC, without_mark};
use serde::Deserialize;

use super::HairFileError;
use super::chain::{Chains, chain};
use super::file::{Hidden, MAX_COPIED_POINTS, RawHair};
use super::format::HairFormat;
use super::partial::Partial;
use super::source::Source;
use super::units::{UpAxis, display_from_linear};
use shared::Shared;

/// `.glb`: one binary file.
pub(super) static BINARY: HairFormat = HairFormat {
    label: "glTF lines",
    extensions: &["glb"],
    signature: "`glTF` or a JSON document (glTF)",
    states_unit: true,
    common_up: UpAxis::Y,
    magics: &[MAGIC],
    may_begin: |_| false,
    by_chance: false,
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
    may_begin: |start| without_mark(start).trim_ascii_start().starts_with(b"{"),
    by_chance: false,
    read,
    write: Some(write::text),
};

const LINES: u32 = 1;
const LINE_LOOP: u32 = 2;
const LINE_STRIP: u32 = 3;
const TRIANGLES: u32 = 4;
const TRIANGLE_FAN: u32 = 6;

/// Attributes of lines.
const POSITION: &str = "POSITION";
const RADIUS: &str = "_RADIUS";
const COLOUR: &str = "COLOR_0";

fn is_line(mode: Option<u32>) -> bool {
    matches!(mode, Some(LINES | LINE_LOOP | LINE_STRIP))
}

/// What a glTF file contains, by its document alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GltfContent {
    /// Whether there are lines, which are hair; hidden ones count only without a surface that is drawn.
    pub lines: bool,
    /// Whether there are triangles, which are a body.
    pub triangles: bool,
    /// Number of animations.
    pub clips: usize,
}

/// What a glTF file, binary or text, contains; `None` for a file that cannot be read.
pub fn gltf_content(path: &Path) -> Option<GltfContent> {
    // Without the buffers, which may be long texts.
    #[derive(Default, Deserialize)]
    #[serde(default)]
    struct Parts {
        scene: Option<usize>,
        scenes: Vec<Scene>,
        nodes: Vec<Node>,
        meshes: Vec<Mesh>,
        animations: Vec<serde::de::IgnoredAny>,
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
    let Parts { scene, scenes, nodes, meshes, animations } = parts;
    let document = Document { scene, scenes, nodes, meshes, ..Document::default() };
    let is_surface = |mode: Option<u32>| (TRIANGLES..=TRIANGLE_FAN).contains(&mode.unwrap_or(TRIANGLES));
    let modes = || document.meshes.iter().flat_map(|mesh| &mesh.primitives).map(|primitive| primitive.mode);
    let shown = shown(&document);
    let drawn = || shown.iter().filter(|(.., is_visible)| *is_visible).map(|(primitive, ..)| primitive.mode);
    Some(GltfContent {
        lines: drawn().any(is_line) || modes().any(is_line) && !drawn().any(is_surface),
        triangles: modes().any(is_surface),
        clips: animations.len(),
    })
}

fn read(name: &str, source: Source<'_>) -> Result<RawHair, HairFileError> {
    let folder = source.folder();
    let bytes = source.into_bytes(name)?;
    let asset = Asset::read(name, &bytes, folder.as_deref()).map_err(refused)?;
    let (document, accessors) = (&asset.document, asset.accessors());
    let shown = shown(document);
    let each = || shown.iter().map(|(primitive, ..)| *primitive).filter(|primitive| is_line(primitive.mode));
    let of =
        |attribute: &'static str| move |primitive: &Primitive| primitive.attributes.get(attribute).copied();
    let mut lines = Lines {
        name,
        accessors: &accessors,
        positions: Shared::new(each().filter_map(of(POSITION))),
        radii: Shared::new(each().filter_map(of(RADIUS))),
        linear: Shared::new(each().filter_map(of(COLOUR))),
        indices: Shared::new(each().filter_map(|primitive| primitive.indices)),
        most_points: MAX_COPIED_POINTS.max(bytes.len()),
        raw: RawHair::new(Vec::new(), Vec::new()),
        widths: Partial::new(f32::NAN),
        colours: Partial::new([f32::NAN; 3]),
        surfaces: 0,
    };
    for (primitive, transform, is_visible) in &shown {
        let first = lines.raw.point_counts.len();
        lines.primitive(primitive, *transform)?;
        lines.raw.hide_from(first, (!is_visible).then_some(Hidden::Invisible));
    }
    lines.finish()
}

/// The primitives of the scene with their transforms, and whether they are visible.
fn shown(document: &Document) -> Vec<(&Primitive, Mat4, bool)> {
    let mut shown = Vec::new();
    for (node, transform, is_visible) in nodes(document) {
        let mesh = document.nodes[node].mesh.and_then(|mesh| document.meshes.get(mesh));
        let primitives = mesh.iter().flat_map(|mesh| &mesh.primitives);
        shown.extend(primitives.map(|primitive| (primitive, transform, is_visible)));
    }
    shown
}

fn refused(error: GltfError) -> HairFileError {
    let malformed = |name, offset, found, wanted| HairFileError::Malformed { name, offset, found, wanted };
    match error {
        GltfError::Read { file: name, source } => HairFileError::Io { name, source },
        GltfError::Malformed { file, offset, place, found, wanted } => {
            let found = if place.starts_with("byte ") { found } else { format!("{place} with {found}") };
            malformed(file, offset, found, wanted)
        }
        GltfError::Extension { file, extension, advice } => {
            malformed(file, 0, format!("the extension {extension}"), format!("a file without it: {advice}"))
        }
        GltfError::Outside { file, uri } => {
            let wanted = "a file in its own folder or below".to_owned();
            malformed(file, 0, format!("a buffer in `{uri}`"), wanted)
        }
    }
}

/// The nodes of the default scene with their transforms, and whether they are visible, parents first. A node that is reached twice
/// counts once.
fn nodes(document: &Document) -> Vec<(usize, Mat4, bool)> {
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
    let mut open: Vec<(usize, Mat4, bool)> =
        roots.into_iter().rev().map(|root| (root, Mat4::IDENTITY, true)).collect();
    let mut found = Vec::new();
    while let Some((node, parent, above_is_visible)) = open.pop() {
        let (Some(seen), Some(content)) = (seen.get_mut(node), document.nodes.get(node)) else { continue };
        if std::mem::replace(seen, true) {
            continue;
        }
        let mut own = content.transform();
        // A node of scale 0 hides what it carries, as in an animation of one mesh per frame. Its size is not known.
        let is_collapsed = size_of(&own) < 1e-9;
        if is_collapsed {
            own = Mat4::from_translation(own.w_axis.truncate());
        }
        let transform = parent * own;
        let is_visible = above_is_visible && content.is_visible() && !is_collapsed;
        found.push((node, transform, is_visible));
        open.extend(content.children.iter().rev().map(|&child| (child, transform, is_visible)));
    }
    found
}

/// The largest factor by which a transform multiplies an axis.
fn size_of(transform: &Mat4) -> f32 {
    let axes = [transform.x_axis, transform.y_axis, transform.z_axis];
    axes.into_iter().map(|axis| axis.truncate().length()).fold(0.0, f32::max)
}

/// The strands read so far.
struct Lines<'a> {
    name: &'a str,
    accessors: &'a Accessors<'a>,
    positions: Shared<[f32; 3]>,
    radii: Shared<[f32; 1]>,
    /// Colours in linear light.
    linear: Shared<[f32; 4]>,
    indices: Shared<[u32; 1]>,
    most_points: usize,
    raw: RawHair,
    widths: Partial<f32>,
    colours: Partial<[f32; 3]>,
    /// Primitives that are no lines.
    surfaces: u64,
}

impl Lines<'_> {
    fn primitive(&mut self, primitive: &Primitive, transform: Mat4) -> Result<(), HairFileError> {
        if !is_line(primitive.mode) {
            self.surfaces += 1;
            return Ok(());
        }
        let accessors = self.accessors;
        let of = |attribute: &str| primitive.attributes.get(attribute).copied();
        let Some(position) = of(POSITION) else { return Ok(()) };
        let positions = self.positions.get(position, || accessors.read(position)).map_err(refused)?;
        let chains = self.strands(primitive, &positions)?;
        if self.raw.points.len() + chains.vertices.len() > self.most_points {
            let found = "a scene that shows the same points again and again".to_owned();
            return Err(self.malformed(found, &format!("{} points at most", self.most_points)));
        }
        // Lines that are flattened keep their width.
        let (volume, size) = (transform.determinant().abs(), size_of(&transform));
        let scale = if volume > 1e-9 * size.powi(3) { volume.cbrt() } else { size };
        let count = positions.len();
        let same_length = |lines: &Self, what: &str, length: usize| {
            if length == count {
                return Ok(());
            }
            Err(lines.malformed(
                format!(
                    "{} of {what} for {}",
                    counted(length, "value", "values"),
                    counted(count, "point", "points")
                ),
                "one per point",
            ))
        };
        let end = self.raw.points.len() + chains.vertices.len();
        if let Some(radius) = of(RADIUS) {
            let radii = self.radii.get(radius, || accessors.read(radius)).map_err(refused)?;
            same_length(self, RADIUS, radii.len())?;
            let widths = &mut self.widths.values;
            widths.extend(chains.vertices.iter().map(|&v| 2.0 * radii[v as usize][0] * scale));
        }
        self.widths.end_at(end, of(RADIUS).is_some());
        // The base colour of a material is white unless it states one, and multiplies the colours of vertices.
        let material = primitive.material.and_then(|material| accessors.document.materials.get(material));
        let base = material.and_then(|material| material.pbr_metallic_roughness.base_color_factor);
        let base_linear = base.map_or(Vec3::ONE, |[r, g, b, _]| Vec3::new(r, g, b));
        if let Some(colour) = of(COLOUR) {
            let linear = self.linear.get(colour, || accessors.read_3_or_4(colour)).map_err(refused)?;
            same_length(self, COLOUR, linear.len())?;
            let display = |&v: &u32| {
                let [r, g, b, _] = linear[v as usize];
                (base_linear * Vec3::new(r, g, b)).to_array().map(display_from_linear)
            };
            self.colours.values.extend(chains.vertices.iter().map(display));
        } else if base.is_some() {
            self.colours.values.resize(end, base_linear.to_array().map(display_from_linear));
        }
        self.colours.end_at(end, of(COLOUR).is_some() || base.is_some());
        self.raw.points.extend(
            chains.vertices.iter().map(|&v| transform.transform_point3(Vec3::from(positions[v as usize]))),
        );
        self.raw.point_counts.extend(chains.counts);
        Ok(())
    }

    fn malformed(&self, found: String, wanted: &str) -> HairFileError {
        HairFileError::Malformed { name: self.name.to_owned(), offset: 0, found, wanted: wanted.to_owned() }
    }

    /// The strands of a primitive as sequences of its vertices.
    fn strands(&mut self, primitive: &Primitive, positions: &[[f32; 3]]) -> Result<Chains, HairFileError> {
        let points = positions.len();
        let listed = match primitive.indices {
            Some(indices) => {
                let accessors = self.accessors;
                let listed =
                    self.indices.get(indices, || accessors.read_indices(indices)).map_err(refused)?;
                if let Some([index]) = listed.iter().find(|[index]| *index as usize >= points) {
                    let found = format!("accessor {indices} with the index {index}");
                    return Err(self.malformed(found, &format!("indices of {points} points")));
                }
                Some(listed.iter().map(|[index]| *index).collect::<Vec<u32>>())
            }
            None => None,
        };
        if primitive.mode != Some(LINES) {
            let mut vertices = listed.unwrap_or_else(|| (0..points as u32).collect());
            if primitive.mode == Some(LINE_LOOP) {
                vertices.extend(vertices.first().copied());
            }
            return Ok(Chains { counts: vec![vertices.len() as u32], vertices, first_listed: vec![0] });
        }
        if let Some(mut listed) = listed {
            // Counted from the first vertex in use, because primitives that share vertices use few of them each.
            let (first, last) = listed.iter().fold((u32::MAX, 0), |(a, b), &v| (a.min(v), b.max(v)));
            let first = first.min(last);
            for vertex in &mut listed {
                *vertex -= first;
            }
            let mut chains = chain(listed.as_chunks::<2>().0, (last - first) as usize + 1);
            for vertex in &mut chains.vertices {
                *vertex += first;
            }
            return Ok(chains);
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
            return Err(self.malformed(found, "primitives of the mode LINES, LINE_LOOP or LINE_STRIP"));
        }
        if self.surfaces > 0 {
            let meshes = counted(
                self.surfaces,
                "mesh of points or triangles was",
                "meshes of points or triangles were",
            );
            self.raw.notes.push(format!("{meshes} left out: only lines are hair."));
        }
        self.raw.thickness = self.widths.finish(&mut self.raw);
        self.raw.colours = self.colours.finish(&mut self.raw);
        Ok(self.raw)
    }
}

#[cfg(test)]
mod tests;
