//! Groups of curves, and the places of their roots on a surface.

use lovelock_alembic::{AlembicError, Archive, Property};

use super::objects::{CurveObject, Parameter};
use crate::io::marks::{Marks, per_curve};

/// The most bytes of the names of an object's groups.
const LONGEST_NAMES: u64 = 1 << 26;

/// Adds those of an object. `counts` are the numbers of control points of its curves.
pub(super) fn add(
    marks: &mut Marks,
    archive: &mut Archive<'_>,
    object: &CurveObject,
    counts: &[usize],
    secs: f64,
) -> Result<(), AlembicError> {
    let groups = pairs(archive, object.groups.as_ref(), secs)?;
    let groups = groups.and_then(|groups| per_curve(&groups, counts));
    let names = names(archive, object.group_names.as_ref(), counts.len(), secs)?;
    let uvs = pairs(archive, object.root_uvs.as_ref(), secs)?.and_then(|uvs| per_curve(&uvs, counts));
    marks.add(
        counts.len(),
        groups.map(|groups| groups.iter().map(|[group, _]| *group as i32).collect()),
        names.and_then(|names| per_curve(&names, counts)),
        uvs.map(|uvs| uvs.iter().map(|uv| uv.map(|number| number as f32)).collect()),
    );
    Ok(())
}

/// The first two numbers of each value, with the indices applied.
fn pairs(
    archive: &mut Archive<'_>,
    values: Option<&Parameter>,
    secs: f64,
) -> Result<Option<Vec<[f64; 2]>>, AlembicError> {
    let Some(parameter) = values else { return Ok(None) };
    let extent = usize::from(parameter.values.ty.extent).max(1);
    let mut elements: Vec<[f64; 2]> = Vec::new();
    numbers(archive, &parameter.values, secs, &mut |block| {
        elements.extend(block.chunks_exact(extent).map(|v| [v[0], v.get(1).copied().unwrap_or_default()]));
    })?;
    let Some(indices) = &parameter.indices else { return Ok(Some(elements)) };
    let mut picked = Vec::new();
    numbers(archive, indices, secs, &mut |block| {
        picked.extend(block.iter().map(|&index| elements.get(index as usize).copied()));
    })?;
    Ok(picked.into_iter().collect())
}

/// The name of each curve's group, or one for all.
fn names(
    archive: &mut Archive<'_>,
    values: Option<&Parameter>,
    curves: usize,
    secs: f64,
) -> Result<Option<Vec<String>>, AlembicError> {
    let Some(parameter) = values else { return Ok(None) };
    let (sample, ..) = archive.times(&parameter.values).around(secs, parameter.values.samples);
    if archive.elements(&parameter.values, sample)? > LONGEST_NAMES {
        return Ok(None);
    }
    let texts = archive.texts(&parameter.values, sample, LONGEST_NAMES)?;
    let Some(indices) = &parameter.indices else { return Ok(Some(texts)) };
    let mut places = Vec::new();
    numbers(archive, indices, secs, &mut |block| {
        places.extend(block.iter().map(|&index| index as usize));
    })?;
    // A name for each curve at most, so that a small file stays small.
    let picked = places.iter().take(curves).map(|&place| texts.get(place).cloned()).collect();
    Ok(if places.len() > curves { None } else { picked })
}

fn numbers(
    archive: &mut Archive<'_>,
    property: &Property,
    secs: f64,
    take: &mut dyn FnMut(&[f64]),
) -> Result<(), AlembicError> {
    let (sample, ..) = archive.times(property).around(secs, property.samples);
    archive.numbers(property, sample, take)
}
