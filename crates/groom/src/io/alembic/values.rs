//! Parameter along curves: widths and colours.

use glam::Vec3;
use lovelock_alembic::{AlembicError, Archive};

use super::objects::{CurveObject, Parameter};
use crate::io::basis::{Shape, Spread};

/// Gives one value for each point of the polylines to `take`. Returns whether the values fit the curves; a note says if not.
#[expect(clippy::too_many_arguments, reason = "each is a part of one object of curves")]
pub(super) fn spread<const N: usize>(
    archive: &mut Archive<'_>,
    object: &CurveObject,
    values: &Parameter,
    secs: f64,
    counts: &[usize],
    shape: Shape,
    notes: &mut Vec<String>,
    take: &mut dyn FnMut([f32; N]),
) -> Result<bool, AlembicError> {
    let (sample, ..) = archive.times(&values.values).around(secs, values.values.samples);
    let count = archive.elements(&values.values, sample)?;
    let indices = match &values.indices {
        None => None,
        Some(indices) => {
            let (sample, ..) = archive.times(indices).around(secs, indices.samples);
            let mut all = Vec::new();
            archive.numbers(indices, sample, &mut |block| all.extend(block.iter().map(|&v| v as u32)))?;
            Some(all)
        }
    };
    let given = indices.as_ref().map_or(count, |indices| indices.len() as u64);
    let Some(way) = Spread::of(values.scope, given as usize, counts, shape) else {
        notes.push(format!(
            "{}: {given} values of {} fit no interpolation and were left out.",
            object.path, values.name
        ));
        return Ok(false);
    };
    if way == Spread::Vertex && indices.is_none() && shape.keeps_points() {
        archive.vectors(&values.values, sample, take)?;
        return Ok(true);
    }
    let mut read: Vec<Vec3> = Vec::new();
    archive.vectors(&values.values, sample, &mut |v: [f32; N]| {
        read.push(Vec3::from_array(std::array::from_fn(|axis| v.get(axis).copied().unwrap_or(0.0))));
    })?;
    if let Some(indices) = indices {
        let picked: Option<Vec<Vec3>> =
            indices.iter().map(|&index| read.get(index as usize).copied()).collect();
        let Some(picked) = picked else {
            notes.push(format!(
                "{}: {} has an index that is out of range, and was left out.",
                object.path, values.name
            ));
            return Ok(false);
        };
        read = picked;
    }
    for value in shape.spread(way, &read, counts) {
        take(std::array::from_fn(|axis| value[axis]));
    }
    Ok(true)
}
