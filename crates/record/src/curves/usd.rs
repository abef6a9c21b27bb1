//! USD: `BasisCurves` and a `Mesh` with time samples, as text or as a binary crate, with the `openusd` library.
//!
//! Curves are linear, because strands are rendered as straight segments; a cubic basis would bend them between their points.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::Vec3;
use openusd::gf::Vec3f;
use openusd::sdf::{self, ChildrenKey, SpecData, SpecType, Value};
use openusd::tf::Token;
use openusd::usda::TextWriter;
use openusd::usdc::CrateWriter;

use super::layer::{SpooledLayer, Track, child, uniform};
use super::spool::{Spool, bounds};
use super::{CurveBody, CurveFrame, CurveReport, CurveScene, crate_tail, usd_look};
use crate::RecordError;
use crate::partial::{Opener, PartialFile, partial_path};

/// The most bytes of one array of points with all its times. A larger groom is divided into several prims, so that
/// memory stays bounded for recordings of any length.
const PRIM_BYTES: u64 = 256 << 20;

pub(super) struct UsdWriter {
    target: PathBuf,
    file: PartialFile,
    text: bool,
    scene: CurveScene,
    prims: Vec<Range<usize>>,
    spool: Spool,
    /// Bounding box of each prim in each frame, frame after frame; the last one of a frame is the body's, if there is a body.
    extents: Vec<[[f32; 3]; 2]>,
}

impl UsdWriter {
    pub(super) fn create(
        path: &Path,
        scene: CurveScene,
        text: bool,
        opener: &Opener,
    ) -> Result<Self, RecordError> {
        let file = PartialFile::create(path, opener)
            .map_err(|error| RecordError::io(path, "create the file", error))?;
        let spool = Spool::create(path, &scene, true)?;
        let prims = divide(&scene.first_point, (PRIM_BYTES / (12 * scene.frames)) as usize);
        Ok(Self { target: path.to_owned(), file, text, scene, prims, spool, extents: Vec::new() })
    }

    pub(super) fn push(&mut self, frame: &CurveFrame<'_>) -> Result<(), RecordError> {
        self.spool.push(frame)?;
        let [x, y, z] = frame.points;
        for prim in &self.prims {
            let points = points_of(&self.scene.first_point, prim);
            // Half of the width extends to each side of a point.
            let half = self.scene.widths[points.clone()].iter().copied().fold(0.0, f32::max) / 2.0;
            let [low, high] = bounds(points.map(|i| [x[i], y[i], z[i]]));
            self.extents.push([low.map(|v| v - half), high.map(|v| v + half)]);
        }
        if let Some(body) = frame.body.filter(|_| self.spool.vertices() > 0) {
            self.extents.push(bounds(body.positions.iter().map(Vec3::to_array)));
        }
        Ok(())
    }

    pub(super) fn finish(mut self) -> Result<CurveReport, RecordError> {
        self.spool.close()?;
        let frames = self.spool.frames;
        let textures = usd_look::folder_of(&self.target);
        let target = &self.target;
        let failed = |error| RecordError::io(target, "write the images beside the file", error);
        if let Some(body) = &self.scene.body {
            usd_look::write_images(target, &textures, body).map_err(failed)?;
        }
        let layer = build((self.spool, self.text), &self.scene, &self.prims, &self.extents, &textures);
        let written = if self.text {
            TextWriter::write(&layer, &mut self.file)
        } else {
            CrateWriter::write(&layer, &mut self.file)
        };
        let target = &self.target;
        let failed = |error| RecordError::io(target, "write the file", error);
        if let Some(error) = layer.take_failure() {
            return Err(failed(error));
        }
        written.map_err(|error| {
            failed(error.downcast().unwrap_or_else(|error| std::io::Error::other(format!("{error:#}"))))
        })?;
        let mut seal = || {
            if !self.text {
                self.file.flush()?;
                crate_tail::mend(&mut File::open(partial_path(target))?, &mut self.file)?;
            }
            self.file.seek(SeekFrom::End(0))
        };
        let bytes = seal().map_err(failed)?;
        self.file.commit(true).map_err(failed)?;
        Ok(CurveReport { frames, bytes })
    }
}

/// Divides curves into runs of at most `most` points in all, but of at least one curve.
fn divide(first_point: &[u32], most: usize) -> Vec<Range<usize>> {
    let mut prims = Vec::new();
    let mut start = 0;
    for curve in 0..first_point.len() - 1 {
        if curve > start && (first_point[curve + 1] - first_point[start]) as usize > most {
            prims.push(start..curve);
            start = curve;
        }
    }
    prims.push(start..first_point.len() - 1);
    prims
}

fn points_of(first_point: &[u32], prim: &Range<usize>) -> Range<usize> {
    first_point[prim.start] as usize..first_point[prim.end] as usize
}

fn build(
    (spool, is_text): (Spool, bool),
    scene: &CurveScene,
    prims: &[Range<usize>],
    extents: &[[[f32; 3]; 2]],
    textures: &str,
) -> SpooledLayer {
    let [positions_at, normals_at] = spool.body_at();
    let mut layer = SpooledLayer::new(spool, scene.first_frame, is_text);
    let times: Vec<f64> = layer.times().collect();
    let a_frame = prims.len() + usize::from(scene.body.is_some());
    let extent = |index: usize| {
        let of_frame = extents.iter().skip(index).step_by(a_frame);
        let corners = of_frame.map(|corners| Value::Vec3fVec(corners.map(Vec3f::from).to_vec()));
        Value::TimeSamples(times.iter().copied().zip(corners).collect())
    };

    let root = sdf::Path::abs_root();
    let rate = scene.rate.as_f64();
    let pseudo_root = layer.spec(root.clone(), SpecType::PseudoRoot);
    for (name, value) in [
        ("defaultPrim", Value::Token(Token::from("Lovelock"))),
        ("upAxis", Value::Token(Token::from("Y"))),
        ("metersPerUnit", Value::Double(1.0)),
        ("timeCodesPerSecond", Value::Double(rate)),
        ("framesPerSecond", Value::Double(rate)),
        ("startTimeCode", Value::Double(scene.first_frame as f64)),
        ("endTimeCode", Value::Double((scene.first_frame + scene.frames - 1) as f64)),
    ] {
        pseudo_root.add(name, value);
    }
    pseudo_root.add(ChildrenKey::PrimChildren, Value::TokenVec(vec![Token::from("Lovelock")]));

    let top = child(&root, "Lovelock");
    let mut children = Vec::new();
    if let Some(body) = &scene.body {
        children.push(Token::from("Body"));
        let materials = child(&top, "Materials");
        let at = child(&top, "Body");
        mesh(&mut layer, &at, body, [positions_at, normals_at], extent(prims.len()), &materials);
        if !body.of_triangles.is_empty() {
            children.push(Token::from("Materials"));
            usd_look::materials(&mut layer, &materials, body, textures);
        }
    }
    children.push(Token::from("Hair"));
    let hair = child(&top, "Hair");
    let names: Vec<String> = (0..prims.len()).map(|index| format!("Strands_{index}")).collect();
    for (index, (prim, name)) in prims.iter().zip(&names).enumerate() {
        curves(&mut layer, child(&hair, name), scene, prim, extent(index));
    }
    layer.prim(hair, "Xform").finish(names.iter().map(|name| Token::from(name.as_str())).collect());
    layer.prim(top, "Xform").kind("component").finish(children);
    layer
}

fn curves(layer: &mut SpooledLayer, path: sdf::Path, scene: &CurveScene, prim: &Range<usize>, extent: Value) {
    let points = points_of(&scene.first_point, prim);
    let mut curves = layer.prim(path, "BasisCurves");
    uniform(curves.attribute("type", "token"), "linear");
    uniform(curves.attribute("wrap", "token"), "nonperiodic");
    let counts = scene.first_point[prim.start..=prim.end].array_windows().map(|[a, b]| (b - a) as i32);
    curves.attribute("curveVertexCounts", "int[]").add("default", Value::IntVec(counts.collect()));
    curves.track("points", "point3f[]", Track { first: points.start, count: points.len() });
    let widths = curves.attribute("widths", "float[]");
    widths.add("default", Value::FloatVec(scene.widths[points.clone()].to_vec()));
    per_vertex(widths);
    let colors = curves.attribute("primvars:displayColor", "color3f[]");
    colors.add("default", triples(&scene.colors[points]));
    per_vertex(colors);
    let marks = &scene.marks;
    if !marks.groups.is_empty() {
        let groups = &marks.groups[prim.clone()];
        let ids = curves.attribute("primvars:groom_group_id", "int[]");
        ids.add("default", Value::IntVec(groups.to_vec()));
        per_curve(ids);
        if !marks.group_names.is_empty() {
            let name = |group: &i32| Token::from(marks.group_names.get(group).map_or("", String::as_str));
            let names = curves.attribute("primvars:groom_group_name", "token[]");
            names.add("default", Value::TokenVec(groups.iter().map(name).collect()));
            per_curve(names);
        }
    }
    if !marks.root_uvs.is_empty() {
        let uvs = marks.root_uvs[prim.clone()].iter().map(|&uv| uv.into()).collect();
        let roots = curves.attribute("primvars:groom_root_uv", "texCoord2f[]");
        roots.add("default", Value::Vec2fVec(uvs));
        per_curve(roots);
    }
    curves.attribute("extent", "float3[]").add("timeSamples", extent);
    curves.finish(Vec::new());
}

fn mesh(
    layer: &mut SpooledLayer,
    path: &sdf::Path,
    body: &CurveBody,
    [positions, normals]: [usize; 2],
    extent: Value,
    materials: &sdf::Path,
) {
    let count = body.bind_positions.len();
    let mut mesh = layer.prim(path.clone(), "Mesh");
    uniform(mesh.attribute("subdivisionScheme", "token"), "none");
    mesh.attribute("faceVertexCounts", "int[]").add("default", Value::IntVec(vec![3; body.triangles.len()]));
    let corners = body.triangles.as_flattened().iter().map(|&vertex| vertex as i32).collect();
    mesh.attribute("faceVertexIndices", "int[]").add("default", Value::IntVec(corners));
    mesh.track("points", "point3f[]", Track { first: positions, count });
    per_vertex(mesh.track("normals", "normal3f[]", Track { first: normals, count }));
    let colors = mesh.attribute("primvars:displayColor", "color3f[]");
    colors.add("default", triples(&body.colors));
    per_vertex(colors);
    mesh.attribute("extent", "float3[]").add("timeSamples", extent);
    let parts = if body.of_triangles.is_empty() { Vec::new() } else { body.parts() };
    for (set, name) in body.coordinates.iter().zip(usd_look::COORDINATES).filter(|(set, _)| !set.is_empty()) {
        // In USD they count from below.
        let flipped = set.iter().map(|at| [at.x, 1.0 - at.y].into()).collect();
        let coordinates = mesh.attribute(name.primvar, "texCoord2f[]");
        coordinates.add("default", Value::Vec2fVec(flipped));
        per_vertex(coordinates);
    }
    if !body.opacity.is_empty() {
        let opacity = mesh.attribute("primvars:displayOpacity", "float[]");
        opacity.add("default", Value::FloatVec(body.opacity.clone()));
        per_vertex(opacity);
    }
    if !parts.is_empty() {
        uniform(mesh.attribute("subsetFamily:materialBind:familyType", "token"), "partition");
    }
    let names: Vec<String> = (0..parts.len()).map(|part| format!("Part_{part}")).collect();
    mesh.finish(names.iter().map(|name| Token::from(name.as_str())).collect());
    for ((material, triangles), name) in parts.into_iter().zip(&names) {
        let mut part = layer.prim(child(path, name), "GeomSubset");
        part.api("MaterialBindingAPI");
        uniform(part.attribute("elementType", "token"), "face");
        uniform(part.attribute("familyName", "token"), "materialBind");
        let faces = triangles.into_iter().map(|triangle| triangle as i32).collect();
        part.attribute("indices", "int[]").add("default", Value::IntVec(faces));
        part.relationship("material:binding", usd_look::path_of(materials, material.unwrap_or(0)));
        part.finish(Vec::new());
    }
}

fn per_vertex(spec: &mut SpecData) {
    spec.add("interpolation", Value::Token(Token::from("vertex")));
}

fn per_curve(spec: &mut SpecData) {
    spec.add("interpolation", Value::Token(Token::from("uniform")));
}

fn triples(values: &[Vec3]) -> Value {
    Value::Vec3fVec(values.iter().map(|value| Vec3f::from(value.to_array())).collect())
}

#[cfg(test)]
mod tests {
    use super::divide;

    #[test]
    fn curves_are_divided_into_runs_that_fit() {
        let first_point = [0, 4, 8, 12, 20, 22];
        assert_eq!(divide(&first_point, 100).first(), Some(&(0..5)));
        assert_eq!(divide(&first_point, 8), [0..2, 2..3, 3..4, 4..5]);
        // A curve that is too long is a run of its own.
        assert_eq!(divide(&first_point, 1), [0..1, 1..2, 2..3, 3..4, 4..5]);
    }
}
