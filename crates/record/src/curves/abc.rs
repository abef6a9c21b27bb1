//! Alembic: curves and a mesh over time, in the Ogawa form.
//!
//! Objects have the names of the USD export: `/Lovelock/Body` and `/Lovelock/Hair/Strands_0`. Alembic states no unit; other programs
//! take its numbers in their own one, so these are metres with Y up. Curves are linear, because strands are rendered as straight
//! segments. Attributes with names that start with `groom_` are those of Unreal's *Alembic for Grooms Specification*, version
//! 1.5, with its types and scopes.

use std::f32::consts::{PI, TAU};
use std::io;
use std::path::Path;

use bytemuck::{NoUninit, cast_slice};
use glam::Vec3;
use lovelock_alembic::{ArchiveWriter, CompoundTree, DataType, ObjectTree, Pod, Samples, Stored, Times};
use lovelock_groom::METRES_Y_UP;

use super::expected::Expected;
use super::spool::bounds;
use super::{CurveBody, CurveFrame, CurveReport, CurveScene};
use crate::RecordError;
use crate::partial::{Opener, PartialFile};

/// The version of Unreal's specification.
const GROOM_VERSION: [i16; 2] = [1, 5];

const POINT: DataType = DataType::new(Pod::F32, 3);
const INT: DataType = DataType::new(Pod::I32, 1);
const BOX: DataType = DataType::new(Pod::F64, 6);

/// The values of a property over the elements of its object, as in the names of scopes.
#[derive(Clone, Copy)]
enum Scope {
    /// One value.
    Constant,
    /// One value per curve.
    Uniform,
    /// One value per point.
    Vertex,
}

pub(super) struct AbcWriter {
    expected: Expected,
    archive: ArchiveWriter<PartialFile>,
    frames: u64,
    times: u32,
    rate: f64,
    hair: Shape,
    body: Option<(Shape, Samples)>,
    /// Index of the first point of each curve.
    roots: Vec<u32>,
    /// Where the roots lie on their surface, if that is known.
    root_uvs: Vec<[f32; 2]>,
    row: Vec<[f32; 3]>,
}

/// A shape whose points move: its bounds and points over time, and what does not change.
struct Shape {
    bounds: Samples,
    points: Samples,
    /// Name, metadata and samples of the other properties of its schema.
    fixed: Vec<(&'static str, String, Samples)>,
    /// Attributes beyond the schema.
    attributes: Vec<(&'static str, String, Samples)>,
    /// The largest half width.
    half: f32,
}

impl AbcWriter {
    pub(super) fn create(path: &Path, scene: CurveScene, opener: &Opener) -> Result<Self, RecordError> {
        let file = PartialFile::create(path, opener)
            .map_err(|error| RecordError::io(path, "create the file", error))?;
        let expected = Expected::of(path, &scene, true);
        let rate = scene.rate.as_f64();
        let create = || -> io::Result<Self> {
            let mut archive = ArchiveWriter::create(file)?;
            let times = archive.add_times(Times::uniform(scene.first_frame as f64 / rate, 1.0 / rate));
            let hair = Shape::hair(&mut archive, times, &scene)?;
            let body = match &scene.body {
                None => None,
                Some(body) => Some((Shape::body(&mut archive, times, body)?, Samples::array(POINT, times))),
            };
            let (mut roots, root_uvs) = (scene.first_point, scene.marks.root_uvs);
            roots.pop();
            Ok(Self {
                expected,
                archive,
                frames: 0,
                times,
                rate,
                hair,
                body,
                roots,
                root_uvs,
                row: Vec::new(),
            })
        };
        create().map_err(|error| RecordError::io(path, "write the file", error))
    }

    pub(super) fn push(&mut self, frame: &CurveFrame<'_>) -> Result<(), RecordError> {
        self.expected.check(self.frames, frame)?;
        let [x, y, z] = frame.points;
        self.row.clear();
        self.row.extend(x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]));
        let mut write = || -> io::Result<()> {
            if self.frames == 0 {
                let roots = self.roots.iter().map(|&root| Vec3::from(self.row[root as usize]));
                let mut uv = std::mem::take(&mut self.root_uvs);
                if uv.is_empty() {
                    uv = root_uv(roots);
                }
                let ty = DataType::new(Pod::F32, 2);
                let mut store = Store { archive: &mut self.archive, times: self.times };
                let samples = store.samples(ty, uv.as_flattened())?;
                let metadata = parameter(ty, Scope::Uniform, "vector");
                self.hair.attributes.push(("groom_root_uv", metadata, samples));
            }
            self.hair.push(&mut self.archive, &self.row)?;
            if let (Some((shape, normals)), Some(body)) = (&mut self.body, frame.body) {
                shape.push(&mut self.archive, cast_slice(body.positions))?;
                normals.push(self.archive.store(POINT, cast_slice(body.normals))?);
            }
            Ok(())
        };
        let (index, target) = (self.frames, &self.expected.target);
        write().map_err(|error| RecordError::io(target, format!("write frame {index}"), error))?;
        self.frames += 1;
        Ok(())
    }

    pub(super) fn finish(mut self) -> Result<CurveReport, RecordError> {
        self.expected.complete(self.frames)?;
        let target = self.expected.target.clone();
        let mut seal = || -> io::Result<[Samples; 4]> {
            let program = format!("Lovelock {}\0", env!("CARGO_PKG_VERSION"));
            let mut constant = |ty: DataType, bytes: &[u8]| -> io::Result<Samples> {
                let mut samples = Samples::array(ty, 0);
                samples.push(self.archive.store(ty, bytes)?);
                Ok(samples)
            };
            let [major, minor] = GROOM_VERSION;
            let short = DataType::new(Pod::I16, 1);
            let mut inherits = Samples::scalar(DataType::new(Pod::Bool, 1), 0);
            let versions = (constant(short, &major.to_le_bytes())?, constant(short, &minor.to_le_bytes())?);
            let tool = constant(DataType::new(Pod::String, 1), program.as_bytes())?;
            inherits.push(self.archive.store(inherits.ty, &[1])?);
            Ok([versions.0, versions.1, tool, inherits])
        };
        let failed = |error| RecordError::io(&target, "write the file", error);
        let [major, minor, tool, inherits] = seal().map_err(failed)?;

        let strands = self.hair.object("Strands_0", "AbcGeom_Curve_v2", self.frames, None);
        let hair = transform("Hair", &inherits, CompoundTree::default(), vec![strands]);
        let body = self
            .body
            .map(|(shape, normals)| shape.object("Body", "AbcGeom_PolyMesh_v1", self.frames, Some(normals)));
        let mut about = CompoundTree::default();
        for (name, samples) in
            [("groom_version_major", major), ("groom_version_minor", minor), ("groom_tool", tool)]
        {
            let metadata = parameter(samples.ty, Scope::Constant, "");
            about.samples(name, &metadata, samples);
        }
        let top = transform("Lovelock", &inherits, about, body.into_iter().chain([hair]).collect());
        let metadata = format!(
            "FramesPerTimeUnit={:.6};_ai_Application=Lovelock {};_ai_Description={METRES_Y_UP}",
            self.rate,
            env!("CARGO_PKG_VERSION")
        );
        let (file, bytes) = self.archive.finish(&metadata, vec![top]).map_err(failed)?;
        file.commit(true).map_err(failed)?;
        Ok(CurveReport { frames: self.frames, bytes })
    }
}

impl Shape {
    fn hair(archive: &mut ArchiveWriter<PartialFile>, times: u32, scene: &CurveScene) -> io::Result<Self> {
        let mut store = Store { archive, times };
        let counts: Vec<i32> = scene.counts().map(|count| count as i32).collect();
        let ids: Vec<i32> = (0..scene.curves() as i32).collect();
        let width = DataType::new(Pod::F32, 1);
        let widths = store.array(width, &scene.widths)?;
        let colors = store.array(POINT, &scene.colors)?;
        // Type linear, not periodic, no basis.
        let mut basis = Samples::scalar(DataType::new(Pod::U8, 4), times);
        basis.push(store.archive.store(basis.ty, &[1, 0, 0, 0])?);
        let fixed = vec![
            ("nVertices", String::new(), store.samples(INT, &counts)?),
            ("curveBasisAndType", String::new(), basis),
            ("width", parameter(width, Scope::Vertex, ""), store.shared(width, widths)),
        ];
        let short = DataType::new(Pod::I16, 1);
        let attribute =
            |name, ty, scope, interpretation, samples| (name, parameter(ty, scope, interpretation), samples);
        let mut attributes = vec![
            attribute("groom_width", width, Scope::Vertex, "", store.shared(width, widths)),
            attribute("groom_color", POINT, Scope::Vertex, "rgb", store.shared(POINT, colors)),
            // The name that other programs look for.
            attribute("Cd", POINT, Scope::Vertex, "rgb", store.shared(POINT, colors)),
            attribute("groom_id", INT, Scope::Uniform, "", store.samples(INT, &ids)?),
        ];
        let marks = &scene.marks;
        match marks.groups.first() {
            Some(first) if marks.groups.iter().any(|group| group != first) => {
                let groups = store.samples(INT, &marks.groups)?;
                attributes.push(attribute("groom_group_id", INT, Scope::Uniform, "", groups));
            }
            first => {
                let groups = store.samples(INT, &[first.copied().unwrap_or_default()])?;
                attributes.push(attribute("groom_group_id", INT, Scope::Constant, "", groups));
            }
        }
        if !marks.group_names.is_empty() {
            let ty = DataType::new(Pod::String, 1);
            let of = |group: i32| marks.group_names.get(&group).map_or("", String::as_str);
            let mut names = String::new();
            for curve in 0..scene.curves() {
                // Texts end with a zero, so a name cannot contain one.
                names.extend(of(marks.group(curve)).chars().filter(|c| *c != '\0'));
                names.push('\0');
            }
            let names = store.samples(ty, names.as_bytes())?;
            attributes.push(attribute("groom_group_name", ty, Scope::Uniform, "", names));
        }
        if scene.are_guides {
            let guides = vec![1_i16; scene.curves()];
            attributes.push(attribute(
                "groom_guide",
                short,
                Scope::Uniform,
                "",
                store.samples(short, &guides)?,
            ));
        }
        let half = scene.widths.iter().copied().fold(0.0, f32::max) / 2.0;
        Ok(Self { fixed, attributes, half, ..Self::moving(times) })
    }

    fn body(archive: &mut ArchiveWriter<PartialFile>, times: u32, body: &CurveBody) -> io::Result<Self> {
        let mut store = Store { archive, times };
        // Faces are clockwise seen from outside.
        let corners: Vec<i32> =
            body.triangles.iter().flat_map(|&[a, b, c]| [c, b, a]).map(|vertex| vertex as i32).collect();
        let fixed = vec![
            (".faceIndices", String::new(), store.samples(INT, &corners)?),
            (".faceCounts", String::new(), store.samples(INT, &vec![3_i32; body.triangles.len()])?),
        ];
        let colors = store.samples(POINT, cast_slice::<Vec3, f32>(&body.colors))?;
        let attributes = vec![("Cd", parameter(POINT, Scope::Vertex, "rgb"), colors)];
        Ok(Self { fixed, attributes, ..Self::moving(times) })
    }

    fn moving(times: u32) -> Self {
        Self {
            bounds: Samples::scalar(BOX, times),
            points: Samples::array(POINT, times),
            fixed: Vec::new(),
            attributes: Vec::new(),
            half: 0.0,
        }
    }

    fn push(&mut self, archive: &mut ArchiveWriter<PartialFile>, points: &[[f32; 3]]) -> io::Result<()> {
        let [low, high] = bounds(points.iter().copied());
        let corners = [low.map(|v| f64::from(v - self.half)), high.map(|v| f64::from(v + self.half))];
        self.bounds.push(archive.store(BOX, cast_slice(corners.as_flattened()))?);
        self.points.push(archive.store(POINT, cast_slice(points))?);
        Ok(())
    }

    /// The object with its schema. What does not change has as many samples as the points.
    fn object(self, name: &str, schema: &str, frames: u64, normals: Option<Samples>) -> ObjectTree {
        let repeated = |mut samples: Samples| {
            (1..frames).for_each(|_| samples.repeat());
            samples
        };
        let mut geometry = CompoundTree::default();
        geometry.samples(".selfBnds", "interpretation=box", self.bounds);
        geometry.samples("P", "geoScope=vtx;interpretation=point", self.points);
        for (name, metadata, samples) in self.fixed {
            geometry.samples(name, &metadata, repeated(samples));
        }
        if let Some(normals) = normals {
            geometry.samples("N", &parameter(POINT, Scope::Vertex, "normal"), normals);
        }
        let mut attributes = CompoundTree::default();
        for (name, metadata, samples) in self.attributes {
            attributes.samples(name, &metadata, repeated(samples));
        }
        geometry.compound(".arbGeomParams", "", attributes);
        let metadata = format!("schema={schema};schemaBaseType=AbcGeom_GeomBase_v1");
        let mut properties = CompoundTree::default();
        properties.compound(".geom", &metadata, geometry);
        let metadata = format!("{metadata};schemaObjTitle={schema}:.geom");
        ObjectTree { name: name.to_owned(), metadata, properties, children: Vec::new() }
    }
}

/// Stores arrays that do not change.
struct Store<'a> {
    archive: &'a mut ArchiveWriter<PartialFile>,
    times: u32,
}

impl Store<'_> {
    fn array<T: NoUninit>(&mut self, ty: DataType, values: &[T]) -> io::Result<Stored> {
        self.archive.store(ty, cast_slice(values))
    }

    fn shared(&self, ty: DataType, stored: Stored) -> Samples {
        let mut samples = Samples::array(ty, self.times);
        samples.push(stored);
        samples
    }

    fn samples<T: NoUninit>(&mut self, ty: DataType, values: &[T]) -> io::Result<Samples> {
        let stored = self.array(ty, values)?;
        Ok(self.shared(ty, stored))
    }
}

/// An object that transforms nothing and holds others.
fn transform(name: &str, inherits: &Samples, about: CompoundTree, children: Vec<ObjectTree>) -> ObjectTree {
    let mut schema = CompoundTree::default();
    schema.samples(".inherits", "", inherits.clone());
    schema.compound(".arbGeomParams", "", about);
    let mut properties = CompoundTree::default();
    properties.compound(".xform", "schema=AbcGeom_Xform_v3", schema);
    let metadata = "schema=AbcGeom_Xform_v3;schemaObjTitle=AbcGeom_Xform_v3:.xform".to_owned();
    ObjectTree { name: name.to_owned(), metadata, properties, children }
}

/// Coordinates of each root, 0 to 1: its direction from the middle of all roots, as longitude from the back of the head and
/// latitude from below. The scalp has no coordinates of its own, and this is what Unreal computes if there are none.
fn root_uv(roots: impl Iterator<Item = Vec3> + Clone) -> Vec<[f32; 2]> {
    let [low, high] = bounds(roots.clone().map(|root| root.to_array()));
    let middle = (Vec3::from(low) + Vec3::from(high)) / 2.0;
    let uv = |root: Vec3| {
        let to = root - middle;
        let (across, up) = (to.x.atan2(to.z), to.y.atan2(to.x.hypot(to.z)));
        [across / TAU + 0.5, up / PI + 0.5]
    };
    roots.map(uv).collect()
}

/// Metadata of a parameter of geometry.
fn parameter(ty: DataType, scope: Scope, interpretation: &str) -> String {
    let scope = match scope {
        Scope::Constant => "con",
        Scope::Uniform => "uni",
        Scope::Vertex => "vtx",
    };
    let interpretation = match interpretation {
        "" => String::new(),
        some => format!("interpretation={some};"),
    };
    format!(
        "arrayExtent=1;geoScope={scope};{interpretation}isGeomParam=true;podExtent={};podName={}",
        ty.extent,
        ty.pod.name()
    )
}
