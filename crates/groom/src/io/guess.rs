//! Estimates the unit and axes of a hair file, which few hair formats state.
//!
//! The estimate uses what all heads have in common: a scalp is about 0.15 m across, hair hangs down and back, and there
//! is none on the face.

use glam::{DVec3, Vec3};

use super::file::HairFile;
use super::root_shape::{RootShape, samples};
use super::units::{Facing, Unit, UpAxis, usual_facing};

/// The estimate of [`guess_units`].
#[derive(Clone, Debug, PartialEq)]
pub struct UnitGuess {
    /// Length of one unit of the file, metres.
    pub metres_per_unit: f32,
    /// The named unit of this length; `None` if the groom was scaled to the size of a head.
    pub unit: Option<Unit>,
    /// Which axis points up: `Y` or `Z`.
    pub up: UpAxis,
    /// The axis of the file along which the face looks; never `Auto`.
    pub facing: Facing,
    /// Size of the groom's box in that unit, file axes, metres.
    pub size_m: Vec3,
    /// The reason, as a sentence.
    pub reason: String,
}

/// Estimates the unit, the up axis and the direction of the face.
///
/// Unit: the first of metre, centimetre, millimetre and inch that makes the roots span 0.09 to 0.30 m. If none does,
/// the roots are scaled to span 0.15 m, the width of an adult scalp. The span is the middle one of the three sides of
/// the roots' box, so that neither the length of a mohawk nor the height of a fringe counts.
///
/// USD states both; its points are in metres with Y up already.
///
/// Up: the common axis of the format (Z for `.hair`, Y for TressFX), unless the strands clearly hang along the other
/// one.
///
/// Face: hair leans away from it, and grows lower on the back of a head than on its front.
pub fn guess_units(file: &HairFile) -> UnitGuess {
    let roots = RootShape::of(file);
    let up = guess_up(file, &roots);
    let facing = guess_facing(file, up);
    let span = roots.span();
    // Roots closer together than the rounding of the hair's coordinates are in one place.
    let apart = 1e-6 * file.bounds.size().max_element();
    let across = "0.09 to 0.30 m across";
    let (metres_per_unit, unit, reason) = if file.is_in_metres {
        (1.0, Some(Unit::Metre), "The file states its unit.".to_owned())
    } else if span > apart {
        let named = Unit::NAMED
            .into_iter()
            .find(|unit| unit.metres().is_some_and(|metres| (0.09..=0.30).contains(&(metres * span))));
        match named.and_then(|unit| Some((unit, unit.metres()?))) {
            Some((unit, metres)) => (
                metres,
                Some(unit),
                format!(
                    "The roots span {span:.3} units; at one {} per unit that is a scalp, {across}.",
                    unit.word()
                ),
            ),
            None => (
                0.15 / span,
                None,
                format!(
                    "The roots span {span:.3} units, which is not {across} in any usual unit: scaled to 0.15 m."
                ),
            ),
        }
    } else {
        // All roots are in one place, so only the length of the hair can be used.
        let length = file.bounds.size().max_element();
        let named = Unit::NAMED
            .into_iter()
            .find(|unit| unit.metres().is_some_and(|m| (0.05..=1.5).contains(&(m * length))));
        match named.and_then(|unit| Some((unit, unit.metres()?))) {
            Some((unit, metres)) => {
                (metres, Some(unit), format!("One root; the hair is {length:.3} {} long.", unit.id()))
            }
            None => {
                (0.25 / length, None, format!("One root, and hair {length:.3} units long: scaled to 0.25 m."))
            }
        }
    };
    UnitGuess { metres_per_unit, unit, up, facing, size_m: file.bounds.size() * metres_per_unit, reason }
}

/// Z or Y: the axis along which the strands hang and toward which the roots form a dome, if that is clear.
fn guess_up(file: &HairFile, roots: &RootShape) -> UpAxis {
    if file.is_in_metres {
        return UpAxis::Y;
    }
    let usual = file.common_up;
    let hang = mean(samples(file).map(|strand| (strand[strand.len() - 1] - strand[0]).normalize_or_zero()));
    let dome = roots.sphere.map_or(Vec3::ZERO, |sphere| {
        (mean(samples(file).map(|strand| strand[0])) - sphere.centre) / sphere.radius
    });
    let score = dome - hang;
    // A difference of half a strand's length is clear; the known grooms that hang differ by 0.7 or more.
    match (usual, score.z - score.y) {
        (UpAxis::Z, margin) if margin < -0.5 => UpAxis::Y,
        (UpAxis::Y, margin) if margin > 0.5 => UpAxis::Z,
        _ => usual,
    }
}

/// The horizontal axis opposite to the lean of the hair, toward the higher roots.
pub(crate) fn guess_facing(file: &HairFile, up: UpAxis) -> Facing {
    let up = if up == UpAxis::Auto { guess_up(file, &RootShape::of(file)) } else { up };
    let up_direction = up.direction();
    let mut strands: Vec<&[Vec3]> = samples(file).collect();
    let lean = mean(strands.iter().map(|strand| strand[strand.len() - 1] - strand[0]));
    strands.sort_by(|a, b| a[0].dot(up_direction).total_cmp(&b[0].dot(up_direction)));
    let quarter = (strands.len() / 4).max(1);
    let lower = mean(strands[..quarter].iter().map(|strand| strand[0]));
    let upper = mean(strands[strands.len() - quarter..].iter().map(|strand| strand[0]));
    // The lean counts four times as much, because a fringe has its lower roots in front but still leans back.
    let toward_face = (upper - lower) - 4.0 * lean;
    let usual = usual_facing(up);
    let horizontal = Facing::AXES.into_iter().filter(|facing| facing.is_square_to(up));
    // Sideways must be much clearer, because asymmetric hair is more common than a head that is rotated in its file.
    let score = |facing: Facing| {
        let along = facing.direction().dot(toward_face);
        if facing.direction().dot(usual.direction()) == 0.0 { along / 3.0 } else { along }
    };
    let best = horizontal.fold(usual, |best, facing| if score(facing) > score(best) { facing } else { best });
    // Hair that does not lean says nothing about the direction.
    let clear =
        0.02 * RootShape::of_points(&strands.iter().map(|strand| strand[0]).collect::<Vec<_>>()).span();
    if score(best) > clear { best } else { usual }
}

fn mean(points: impl Iterator<Item = Vec3>) -> Vec3 {
    let (sum, count) = points.fold((DVec3::ZERO, 0_u32), |(sum, n), p| (sum + p.as_dvec3(), n + 1));
    (sum / f64::from(count.max(1))).as_vec3()
}
