//! The curves of a stage over time.

use glam::{DMat4, Vec3};
use lovelock_usd::Value;

use super::stage::Stage;
use super::{read_layer, shape};
use crate::io::HairFileError;
use crate::io::basis::{Shape, Spread};
use crate::io::frames::{CurveFrames, OpenedFrames, Stated, merged};

/// The most times of a file.
const MAX_TIMES: usize = 1 << 20;

struct Frames {
    layer: Stage<'static>,
    /// Each prim with the number of control points of its curves.
    prims: Vec<(usize, Vec<usize>, Shape)>,
    metres_from_stage: DMat4,
    stated: Stated,
    /// Whether a transform of the curves is animated.
    is_moved: bool,
    codes_per_sec: f64,
    /// The time code of 0 seconds.
    start_code: f64,
    times: Vec<f64>,
}

/// The curves of a layer over time, and the hair at the first time.
pub(super) fn open(mut layer: Stage<'static>) -> Result<OpenedFrames, HairFileError> {
    let raw = read_layer(&mut layer)?;
    let frames = Frames::of(layer).map(|frames| Box::new(frames) as Box<dyn CurveFrames>);
    Ok((frames, raw))
}

impl Frames {
    fn of(mut layer: Stage<'static>) -> Result<Self, HairFileError> {
        let space = layer.space()?;
        let (mut prims, mut times, mut is_moved) = (Vec::new(), Vec::new(), false);
        for prim in layer.curves()? {
            if layer.changes(prim, "curveVertexCounts")? {
                let found = format!("{}: curves whose number of points changes", layer.path(prim));
                return Err(layer.malformed(found, "the same ones at all times"));
            }
            times.extend(layer.times(prim, "points")?);
            let of_transform = layer.transform_times(prim)?;
            is_moved |= of_transform.len() > 1;
            times.extend(of_transform);
            times = merged(times);
            if times.len() > MAX_TIMES {
                return Err(layer.malformed(format!("{} times", times.len()), "1048576 at most"));
            }
            let counts = layer.attribute(prim, "curveVertexCounts", usize::MAX)?;
            let counts = counts.map_or_else(Vec::new, Value::into_ints);
            // `read_layer` has refused negative ones.
            let counts = counts.into_iter().map(|count| count.max(0) as usize).collect();
            let shape = shape(&mut layer, prim)?;
            prims.push((prim, counts, shape));
        }
        let rate = layer.metadata("timeCodesPerSecond")?.and_then(|value| value.numbers().first().copied());
        let mut codes_per_sec = rate.unwrap_or(24.0);
        if !(1e-3..=1e6).contains(&codes_per_sec) {
            if times.len() > 1 {
                return Err(
                    layer.malformed(format!("timeCodesPerSecond {codes_per_sec}"), "0.001 to 1000000")
                );
            }
            // Curves that stay need no rate.
            codes_per_sec = 24.0;
        }
        // The clips of a stage begin at its start. A file of Lovelock counts on the dance.
        let own = layer.metadata("defaultPrim")?.is_some_and(|prim| prim.token() == Some("Lovelock"));
        let start = layer.metadata("startTimeCode")?.and_then(|value| value.numbers().first().copied());
        let start_code = start.filter(|start| !own && start.is_finite()).unwrap_or(0.0);
        let times = merged(times.into_iter().map(|code| (code - start_code) / codes_per_sec).collect());
        Ok(Self {
            layer,
            prims,
            metres_from_stage: space.metres_from_stage,
            stated: Stated { unit: space.is_stated, up: space.up_is_stated },
            is_moved,
            codes_per_sec,
            start_code,
            times,
        })
    }
}

impl CurveFrames for Frames {
    fn times(&self) -> &[f64] {
        &self.times
    }

    fn bends(&self) -> bool {
        self.is_moved
    }

    fn stated(&self) -> Stated {
        self.stated
    }

    fn points(&mut self, secs: f64, out: &mut Vec<Vec3>) -> Result<(), HairFileError> {
        out.clear();
        let layer = &mut self.layer;
        layer.set_time(secs * self.codes_per_sec + self.start_code);
        for (prim, counts, shape) in &self.prims {
            let transform = self.metres_from_stage * layer.transform(*prim)?;
            let points = layer.attribute(*prim, "points", usize::MAX)?;
            let points = points.map_or_else(Vec::new, Value::into_vectors);
            if points.len() != counts.iter().sum::<usize>() {
                let found = format!("{}: {} points at {secs} s", layer.path(*prim), points.len());
                return Err(layer.malformed(found, "as many as at the first time"));
            }
            let placed = |p: &Vec3| transform.transform_point3(p.as_dvec3()).as_vec3();
            if shape.keeps_points() {
                out.extend(points.iter().map(placed));
            } else {
                out.extend(shape.spread(Spread::Vertex, &points, counts).iter().map(placed));
            }
        }
        Ok(())
    }
}
