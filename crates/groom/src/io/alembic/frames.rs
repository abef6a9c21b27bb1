//! The curves of an archive over time.

use glam::Vec3;
use lovelock_alembic::{AlembicError, Archive, metadata_value};
use lovelock_base::words::counted;

use super::objects::CurveObject;
use super::{named, refused, shape, transform};
use crate::io::HairFileError;
use crate::io::basis::{Shape, Spread};
use crate::io::frames::{CurveFrames, merged};

/// The most times of a file.
const MAX_TIMES: u64 = 1 << 20;

pub(super) struct Frames {
    pub(super) name: String,
    pub(super) archive: Archive<'static>,
    objects: Vec<(CurveObject, Vec<usize>, Shape)>,
    times: Vec<f64>,
    /// The time in the archive of 0 seconds.
    start_secs: f64,
}

impl Frames {
    pub(super) fn new(
        name: &str,
        mut archive: Archive<'static>,
        objects: Vec<CurveObject>,
    ) -> Result<Self, AlembicError> {
        let mut times = Vec::new();
        let mut all = Vec::new();
        for object in objects.into_iter().filter(|object| object.points.samples > 0) {
            if !object.counts.is_constant() {
                return Err(refused(
                    &object,
                    "curves whose number of points changes",
                    "the same ones at all times",
                ));
            }
            let mut add = |property: &lovelock_alembic::Property| {
                let samples = if property.is_constant() { 1 } else { property.samples };
                if samples > MAX_TIMES {
                    return Err(refused(&object, format!("{samples} samples"), "1048576 at most"));
                }
                let own = archive.times(property);
                times.extend((0..samples).map(|sample| own.secs(sample)));
                Ok(())
            };
            add(&object.points)?;
            let mut above = object.above.as_ref();
            while let Some(at) = above {
                // A transform that stays adds no time.
                if let Some(values) = at.values.as_ref().filter(|values| !values.is_constant()) {
                    add(values)?;
                }
                above = at.above.as_ref();
            }
            times = merged(times);
            let secs = archive.times(&object.points).secs(0);
            let counts = object.counts(&mut archive, secs)?;
            let shape = shape::of(&mut archive, &object, secs, &mut Vec::new())?;
            all.push((object, counts, shape));
        }
        let mut times = merged(times);
        // The clips of other files begin at 0, so curves do, too. An archive of Lovelock counts on the dance.
        let own = metadata_value(archive.metadata(), "_ai_Application")
            .is_some_and(|program| program.to_ascii_lowercase().starts_with("lovelock"));
        let start_secs = if own { 0.0 } else { times[0] };
        for secs in &mut times {
            *secs -= start_secs;
        }
        Ok(Self { name: name.to_owned(), archive, objects: all, times, start_secs })
    }
}

impl CurveFrames for Frames {
    fn times(&self) -> &[f64] {
        &self.times
    }

    fn points(&mut self, secs: f64, out: &mut Vec<Vec3>) -> Result<(), HairFileError> {
        out.clear();
        let secs = secs + self.start_secs;
        for (object, counts, shape) in &self.objects {
            add(&mut self.archive, object, counts, *shape, secs, out)
                .map_err(|error| named(&self.name, error))?;
        }
        Ok(())
    }
}

fn add(
    archive: &mut Archive<'_>,
    object: &CurveObject,
    counts: &[usize],
    shape: Shape,
    secs: f64,
    out: &mut Vec<Vec3>,
) -> Result<(), AlembicError> {
    let transform = transform::to_archive(archive, object, secs)?;
    let placed = |point: [f32; 3]| transform.transform_point3(Vec3::from(point).as_dvec3()).as_vec3();
    let wanted: usize = counts.iter().sum();
    let (sample, next, t) = archive.times(&object.points).around(secs, object.points.samples);
    let check = |archive: &mut Archive<'_>, sample| {
        let found = archive.elements(&object.points, sample)?;
        if found == wanted as u64 {
            return Ok(());
        }
        Err(refused(
            object,
            format!("{} in sample {sample}", counted(found, "point", "points")),
            "as many as at the first time",
        ))
    };
    check(archive, sample)?;
    let start = out.len();
    let mut controls = Vec::new();
    let own = if shape.keeps_points() { &mut *out } else { &mut controls };
    let first = own.len();
    archive.vectors(&object.points, sample, &mut |point| own.push(placed(point)))?;
    // Times of other objects may lie between two samples of this one.
    if t > 1e-6 && t < 1.0 - 1e-6 {
        check(archive, next)?;
        let mut at = first;
        archive.vectors(&object.points, next, &mut |point| {
            own[at] = own[at].lerp(placed(point), t as f32);
            at += 1;
        })?;
    } else if t >= 1.0 - 1e-6 && next != sample {
        check(archive, next)?;
        own.truncate(first);
        archive.vectors(&object.points, next, &mut |point| own.push(placed(point)))?;
    }
    if !shape.keeps_points() {
        out.truncate(start);
        out.extend(shape.spread(Spread::Vertex, &controls, counts));
    }
    Ok(())
}
