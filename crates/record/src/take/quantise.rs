//! Conversion of guides to multiples of a fixed step in head space, and back.

use glam::{Affine3A, DMat3, DVec3};
use lovelock_groom::GuideFrame;

use super::layout::Layout;

/// Length of one step in metres. Rounding moves a point by at most half a step along each axis, 0.0433 mm in all.
pub(super) const STEP_M: f64 = 5e-5;

/// The largest distance of a point from the head, in steps: 6.7 km.
const MAX_STEPS: f64 = (1_u32 << 27) as f64;

/// Writes the guides of `frame` into `out`, in the order of [`Layout::numbers`].
pub(super) fn quantise(frame: &GuideFrame, layout: Layout, out: &mut [i32]) -> Result<(), String> {
    let Layout { guides, points } = layout;
    let from = &frame.guides;
    let total = guides * points;
    if from.points_per_guide != points || [&from.x, &from.y, &from.z].iter().any(|a| a.len() != total) {
        return Err(format!(
            "{} guides of {} points; must be {guides} of {points}",
            from.count(),
            from.points_per_guide
        ));
    }
    let (turn, place) = rigid(&frame.world_from_head)?;
    let back = turn.inverse() * (1.0 / STEP_M);
    let (mut furthest, mut at) = (0.0_f64, 0);
    for guide in 0..guides {
        for point in 0..points {
            let i = guide * points + point;
            let world = DVec3::new(from.x[i].into(), from.y[i].into(), from.z[i].into());
            let steps = back * (world - place);
            let reach = steps.abs().element_sum();
            // NaN counts as the furthest.
            if reach > furthest || reach.is_nan() {
                (furthest, at) = (reach, i);
            }
            let to = point * guides + guide;
            out[to] = nearest(steps.x);
            out[total + to] = nearest(steps.y);
            out[2 * total + to] = nearest(steps.z);
        }
    }
    if furthest.is_nan() || furthest > MAX_STEPS {
        let (x, y, z) = (from.x[at], from.y[at], from.z[at]);
        return Err(format!(
            "guide {}, point {} at [{x}, {y}, {z}] m; must be within {:.0} m of the head",
            at / points,
            at % points,
            MAX_STEPS * STEP_M
        ));
    }
    Ok(())
}

/// The nearest integer; halves are rounded to even.
fn nearest(value: f64) -> i32 {
    // Doubles of this size are integers, so the addition rounds. A call of the system's library for each number
    // would take as long as everything else.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    ((value + WHOLE) - WHOLE) as i32
}

/// Converts the numbers back to guides in world space.
pub(super) fn restore(numbers: &[i32], layout: Layout, frame: &mut GuideFrame) {
    let Layout { guides, points } = layout;
    let total = guides * points;
    let turn = DMat3::from_cols_array(&frame.world_from_head.matrix3.to_cols_array().map(f64::from)) * STEP_M;
    let place = frame.world_from_head.translation.as_dvec3();
    let to = &mut frame.guides;
    to.points_per_guide = points;
    for axis in [&mut to.x, &mut to.y, &mut to.z] {
        axis.resize(total, 0.0);
    }
    for guide in 0..guides {
        for point in 0..points {
            let from = point * guides + guide;
            let steps = DVec3::new(
                numbers[from].into(),
                numbers[total + from].into(),
                numbers[2 * total + from].into(),
            );
            let world = (turn * steps + place).as_vec3();
            let i = guide * points + point;
            (to.x[i], to.y[i], to.z[i]) = (world.x, world.y, world.z);
        }
    }
}

/// Rotation and translation of a rigid transform.
fn rigid(transform: &Affine3A) -> Result<(DMat3, DVec3), String> {
    let turn = DMat3::from_cols_array(&transform.matrix3.to_cols_array().map(f64::from));
    let place = transform.translation.as_dvec3();
    let off = turn.transpose() * turn - DMat3::IDENTITY;
    let worst = off.to_cols_array().iter().fold(0.0_f64, |worst, v| worst.max(v.abs()));
    // The error of a product of a few rotations in single precision is 1e-6.
    let straight = off.is_finite() && worst < 1e-3 && turn.determinant() > 0.0;
    if straight && place.is_finite() {
        Ok((turn, place))
    } else {
        Err(format!("the transform of the head is {transform}; must be a rotation and a translation"))
    }
}
