//! The basis of curves in Alembic.

use lovelock_alembic::{AlembicError, Archive};

use super::objects::CurveObject;
use super::refused;
use crate::io::basis::{Basis, Shape, Wrap};

/// The basis and wrap of an object's curves; linear if it states none.
pub(super) fn of(
    archive: &mut Archive<'_>,
    object: &CurveObject,
    secs: f64,
    notes: &mut Vec<String>,
) -> Result<Shape, AlembicError> {
    let Some(property) = object.basis.as_ref().filter(|basis| basis.samples > 0) else {
        return Ok(Shape::new(Basis::Linear, Wrap::Nonperiodic));
    };
    let (sample, ..) = archive.times(property).around(secs, property.samples);
    let numbers = archive.few(property, sample, 16)?;
    let &[kind, wrap, basis, ..] = numbers.as_slice() else {
        return Err(refused(object, format!("a basis of {} numbers", numbers.len()), "four"));
    };
    let wrap = if wrap == 0.0 { Wrap::Nonperiodic } else { Wrap::Periodic };
    let basis = match (kind as u8, basis as u8) {
        (1, _) => Basis::Linear,
        (0, 1) => Basis::Bezier,
        (0, 3) => Basis::CatmullRom,
        // Cubic curves without a basis are those of a modeller with knots.
        (0, 0 | 2) => Basis::Bspline,
        (2, _) => {
            notes.push(format!("{}: curves of several orders were read as cubic B-splines.", object.path));
            Basis::Bspline
        }
        (kind, basis) => {
            let found = format!("curves of type {kind} and basis {basis}");
            return Err(refused(object, found, "linear, or cubic of bezier, bspline or catmullrom"));
        }
    };
    // Repeated knots at its ends make a B-spline begin and end at its control points.
    if basis == Basis::Bspline && wrap == Wrap::Nonperiodic && begins_at_its_root(archive, object)? {
        return Ok(Shape::new(basis, Wrap::Pinned));
    }
    Ok(Shape::new(basis, wrap))
}

fn begins_at_its_root(archive: &mut Archive<'_>, object: &CurveObject) -> Result<bool, AlembicError> {
    let Some(knots) = object.knots.as_ref().filter(|knots| knots.samples > 0) else { return Ok(false) };
    let (mut first, mut seen) = ([0.0; 3], 0);
    archive.vectors(knots, 0, &mut |[knot]: [f32; 1]| {
        if seen < 3 {
            first[seen] = knot;
            seen += 1;
        }
    })?;
    Ok(seen == 3 && first[0] == first[2])
}
