//! Twist joints: helpers of a rig that distribute the roll of a limb along it, so that the skin does not
//! collapse.

use std::f32::consts::{PI, TAU};

use glam::{Quat, Vec3};

use crate::Skeleton;
use crate::humanoid::{Humanoid, Role, Side, is_twist};

/// A twist joint and the joints that drive it.
struct Twist {
    joint: usize,
    limb: usize,
    /// The roll is that of `to` relative to `from`, about the limb.
    from: usize,
    to: usize,
    /// Direction of the limb at rest, world space.
    axis: Vec3,
    /// Fraction of the roll that the joint adds to the limb's own rotation.
    share: f32,
}

/// Fraction of its own roll that a limb's upper end takes back; the lower end keeps all.
const TAKEN_BACK: f32 = -0.6;

/// The twist joints of a figure. Those at the upper end of upper arms and thighs take back a part of the
/// limb's roll; those along the forearm take over a part of the hand's.
fn find(skeleton: &Skeleton, figure: &Humanoid) -> Vec<Twist> {
    let mut twists = Vec::new();
    for side in Side::BOTH {
        let trunk = |role: Role| figure.get(role).or(figure.get(Role::Hips));
        let chest = figure.get(Role::Clavicle(side)).or(figure.spine.last().copied());
        for (limb, end, before) in [
            (Role::UpperArm(side), Role::Forearm(side), chest),
            (Role::Forearm(side), Role::Hand(side), None),
            (Role::Thigh(side), Role::Shin(side), trunk(Role::Pelvis)),
        ] {
            let (Some(limb), Some(end)) = (figure.get(limb), figure.get(end)) else { continue };
            let (start, stop) = (skeleton.rest_position(limb), skeleton.rest_position(end));
            let Some(axis) = (stop - start).try_normalize() else { continue };
            for (joint, entry) in skeleton.joints.iter().enumerate() {
                if entry.parent != Some(limb) || !is_twist(&entry.name) {
                    continue;
                }
                let along = (skeleton.rest_position(joint) - start).dot(axis) / start.distance(stop);
                match before {
                    Some(from) => twists.push(Twist {
                        joint,
                        limb,
                        from,
                        to: limb,
                        axis,
                        share: TAKEN_BACK * (1.0 - along),
                    }),
                    None => twists.push(Twist {
                        joint,
                        limb,
                        from: limb,
                        to: end,
                        axis,
                        share: along.clamp(0.0, 1.0),
                    }),
                }
            }
        }
    }
    twists
}

/// Computes the rotations of twist joints frame by frame, and returns those joints.
pub(super) fn drive(
    skeleton: &Skeleton,
    figure: &Humanoid,
    driven: &[bool],
    turns: &mut [Vec<Quat>],
) -> Vec<usize> {
    let twists: Vec<Twist> = find(skeleton, figure)
        .into_iter()
        .filter(|t| driven[t.from] && driven[t.to] && driven[t.limb])
        .collect();
    for twist in &twists {
        let mut before = 0.0;
        for frame in turns.iter_mut() {
            let roll = angle_about(frame[twist.from].conjugate() * frame[twist.to], twist.axis);
            // Unwraps the roll, so that it continues past half a turn instead of jumping to the other side.
            before += (roll - before + PI).rem_euclid(TAU) - PI;
            frame[twist.joint] = frame[twist.limb] * Quat::from_axis_angle(twist.axis, twist.share * before);
        }
    }
    twists.into_iter().map(|t| t.joint).collect()
}

/// The twist of a rotation about a unit vector, radians (swing times twist).
fn angle_about(rotation: Quat, axis: Vec3) -> f32 {
    let along = rotation.xyz().dot(axis);
    // A half turn about another axis has no defined twist.
    if along.hypot(rotation.w) < 1e-6 { 0.0 } else { 2.0 * along.atan2(rotation.w) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twist_is_separated_from_swing() {
        let axis = Vec3::new(0.6, 0.0, 0.8);
        for angle in [-2.0, -0.3, 0.0, 1.0, 3.0] {
            let swing = Quat::from_rotation_y(0.7);
            let found = angle_about(swing * Quat::from_axis_angle(axis, angle), axis);
            // The swing's axis is perpendicular to the limb, so the twist is recovered exactly.
            assert!(((found - angle + PI).rem_euclid(TAU) - PI).abs() < 1e-5, "{angle} {found}");
        }
    }
}
