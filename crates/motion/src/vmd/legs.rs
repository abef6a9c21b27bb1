//! Inverse kinematics of a leg: two bones whose end reaches a target.

use glam::{Quat, Vec3};

/// Rotations of a thigh and of a knee, relative to their parents.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    pub(super) thigh: Quat,
    pub(super) knee: Quat,
}

/// Bends the knee about the X axis of the thigh, backward alone, until the ankle is as far from the hip as the target, and
/// then swings the thigh from `thigh` by the smallest rotation that brings the ankle there. Everything is in the space of
/// the thigh's parent with the hip at the origin; `shin` and `ankle` are the offsets of the knee from the hip and of the
/// ankle from the knee at rest. A target out of reach straightens the leg toward it.
pub(super) fn reach(target: Vec3, shin: Vec3, ankle: Vec3, thigh: Quat) -> Leg {
    // |shin + Rx(angle) ankle|^2 = |target|^2: a + b cos(angle) + c sin(angle) = 0.
    let a = shin.length_squared() + ankle.length_squared() - target.length_squared() + 2.0 * shin.x * ankle.x;
    let b = 2.0 * (shin.y * ankle.y + shin.z * ankle.z);
    let c = 2.0 * (shin.z * ankle.y - shin.y * ankle.z);
    let amplitude = b.hypot(c).max(f32::MIN_POSITIVE);
    let angle = (c.atan2(b) + (-a / amplitude).clamp(-1.0, 1.0).acos()).clamp(0.0, std::f32::consts::PI);
    let knee = Quat::from_rotation_x(angle);
    let end = thigh * (shin + knee * ankle);
    Leg { thigh: (swing(end, target) * thigh).normalize(), knee }
}

/// The smallest rotation from one direction to another; none for vectors without direction.
pub(super) fn swing(from: Vec3, to: Vec3) -> Quat {
    match (from.try_normalize(), to.try_normalize()) {
        (Some(from), Some(to)) => Quat::from_rotation_arc(from, to),
        _ => Quat::IDENTITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHIN: Vec3 = Vec3::new(0.0, -5.0, 0.0);

    fn ankle(leg: Leg) -> Vec3 {
        leg.thigh * (SHIN + leg.knee * SHIN)
    }

    #[test]
    fn a_leg_of_two_equal_bones_makes_an_equilateral_triangle() {
        // Five below the hip: sides 5, 5, 5, so the knee bends by 120 degrees and is in front.
        let leg = reach(Vec3::new(0.0, -5.0, 0.0), SHIN, SHIN, Quat::IDENTITY);
        assert!((leg.knee.to_axis_angle().1.to_degrees() - 120.0).abs() < 0.1);
        assert!(ankle(leg).distance(Vec3::new(0.0, -5.0, 0.0)) < 1e-4);
        let knee = leg.thigh * SHIN;
        assert!(knee.distance(Vec3::new(0.0, -2.5, 4.330_127)) < 1e-3, "{knee}");
        // The right angle: a distance of 5 sqrt 2.
        let leg = reach(Vec3::new(0.0, 0.0, 50.0_f32.sqrt()), SHIN, SHIN, Quat::IDENTITY);
        assert!((leg.knee.to_axis_angle().1.to_degrees() - 90.0).abs() < 0.1);
        assert!(ankle(leg).distance(Vec3::new(0.0, 0.0, 50.0_f32.sqrt())) < 1e-4);
    }

    #[test]
    fn targets_out_of_reach_straighten_the_leg() {
        let leg = reach(Vec3::new(0.0, -30.0, 0.0), SHIN, SHIN, Quat::IDENTITY);
        assert!(leg.knee.to_axis_angle().1 < 1e-3 && ankle(leg).distance(Vec3::new(0.0, -10.0, 0.0)) < 1e-3);
        for target in [Vec3::ZERO, Vec3::splat(1e20), Vec3::new(0.0, 10.0, 0.0)] {
            let leg = reach(target, SHIN, SHIN, Quat::IDENTITY);
            assert!(leg.thigh.is_finite() && leg.knee.is_finite(), "{target}");
        }
    }

    #[test]
    fn every_target_in_reach_is_reached_whatever_the_thigh_did() {
        for k in 0..200 {
            let t = k as f32;
            let target = Vec3::new((t * 0.7).sin(), -1.5 + (t * 0.3).cos(), (t * 1.1).sin()) * 3.0;
            let thigh = Quat::from_rotation_y(t) * Quat::from_rotation_x(0.3 * t);
            let leg = reach(target, SHIN, Vec3::new(0.0, -4.0, 0.1), thigh);
            let end = leg.thigh * (SHIN + leg.knee * Vec3::new(0.0, -4.0, 0.1));
            assert!(
                target.length() > 8.9 || target.length() < 1.2 || end.distance(target) < 1e-3,
                "{end} {target}"
            );
        }
    }
}
