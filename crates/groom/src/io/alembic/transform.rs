//! The transform of an object in its archive.

use glam::{DMat4, DVec3};
use lovelock_alembic::{AlembicError, Archive};

use super::objects::{Ancestor, CurveObject};
use super::refused;

/// The most operations of one transform.
const MAX_OPERATIONS: u64 = 256;

/// The transform from an object's own space to the archive at a time: those of all its ancestors.
pub(super) fn to_archive(
    archive: &mut Archive<'_>,
    object: &CurveObject,
    secs: f64,
) -> Result<DMat4, AlembicError> {
    let mut transform = DMat4::IDENTITY;
    let mut at = object.above.as_ref();
    while let Some(above) = at {
        let Some(own) = own(archive, above, secs)? else {
            return Err(refused(object, "a transform with other values than its operations", "all of them"));
        };
        transform = own * transform;
        if !inherits(archive, above, secs)? {
            break;
        }
        at = above.above.as_ref();
    }
    if transform.is_finite() {
        Ok(transform)
    } else {
        Err(refused(object, "a transform that is not finite", "numbers"))
    }
}

fn inherits(archive: &mut Archive<'_>, above: &Ancestor, secs: f64) -> Result<bool, AlembicError> {
    let Some(inherits) = above.inherits.as_ref().filter(|inherits| inherits.samples > 0) else {
        return Ok(true);
    };
    let (sample, ..) = archive.times(inherits).around(secs, inherits.samples);
    Ok(archive.few(inherits, sample, 1)?.first().is_none_or(|&value| value != 0.0))
}

/// The operations of one transform, with their values between two samples; `None` if there are too few values.
fn own(archive: &mut Archive<'_>, above: &Ancestor, secs: f64) -> Result<Option<DMat4>, AlembicError> {
    let samples =
        |property: &Option<_>| property.as_ref().is_some_and(|p: &lovelock_alembic::Property| p.samples > 0);
    let (Some(operations), Some(values)) = (&above.operations, &above.values) else {
        return Ok(Some(DMat4::IDENTITY));
    };
    if !samples(&above.operations) || !samples(&above.values) {
        return Ok(Some(DMat4::IDENTITY));
    }
    let operations = archive.few(operations, 0, MAX_OPERATIONS)?;
    let (sample, next, t) = archive.times(values).around(secs, values.samples);
    let mut numbers = archive.few(values, sample, 16 * MAX_OPERATIONS)?;
    if t > 0.0 {
        let later = archive.few(values, next, 16 * MAX_OPERATIONS)?;
        for (number, later) in numbers.iter_mut().zip(later) {
            *number += t * (later - *number);
        }
    }
    let (mut transform, mut rest) = (DMat4::IDENTITY, numbers.as_slice());
    for operation in operations {
        // The upper half of the byte is the kind, the lower one a hint.
        let kind = operation as u8 >> 4;
        let Some((own, after)) = rest.split_at_checked(channels(kind)) else { return Ok(None) };
        rest = after;
        transform *= matrix(kind, own);
    }
    Ok(Some(transform))
}

/// How many values an operation takes.
fn channels(kind: u8) -> usize {
    match kind {
        0 | 1 => 3,
        2 => 4,
        3 => 16,
        4..=6 => 1,
        _ => usize::MAX,
    }
}

/// The matrix of an operation, for column vectors.
fn matrix(kind: u8, values: &[f64]) -> DMat4 {
    match (kind, values) {
        (0, &[x, y, z]) => DMat4::from_scale(DVec3::new(x, y, z)),
        (1, &[x, y, z]) => DMat4::from_translation(DVec3::new(x, y, z)),
        (2, &[x, y, z, degrees]) => match DVec3::new(x, y, z).try_normalize() {
            Some(axis) => DMat4::from_axis_angle(axis, degrees.to_radians()),
            None => DMat4::IDENTITY,
        },
        (4, &[degrees]) => DMat4::from_rotation_x(degrees.to_radians()),
        (5, &[degrees]) => DMat4::from_rotation_y(degrees.to_radians()),
        (6, &[degrees]) => DMat4::from_rotation_z(degrees.to_radians()),
        // Alembic uses row vectors, so its rows are the columns here.
        (_, values) => values.first_chunk::<16>().map_or(DMat4::IDENTITY, DMat4::from_cols_array),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_operation_moves_a_point_as_its_name_says() {
        let moved = |kind, values: &[f64]| matrix(kind, values).transform_point3(DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(moved(0, &[2.0, 3.0, 4.0]), DVec3::new(2.0, 6.0, 12.0));
        assert_eq!(moved(1, &[2.0, 3.0, 4.0]), DVec3::new(3.0, 5.0, 7.0));
        // A quarter turn around Z maps x to y.
        for turned in [moved(2, &[0.0, 0.0, 5.0, 90.0]), moved(6, &[90.0])] {
            assert!(turned.abs_diff_eq(DVec3::new(-2.0, 1.0, 3.0), 1e-12), "{turned}");
        }
        assert!(moved(4, &[90.0]).abs_diff_eq(DVec3::new(1.0, -3.0, 2.0), 1e-12));
        assert!(moved(5, &[90.0]).abs_diff_eq(DVec3::new(3.0, 2.0, -1.0), 1e-12));
        let rows = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 7.0, 8.0, 9.0, 1.0];
        assert_eq!(moved(3, &rows), DVec3::new(8.0, 10.0, 12.0));
        assert_eq!(channels(9), usize::MAX);
    }
}
