//! The rest pose of a file without skins and bind poses: the pose of its nodes, of their zero rotations or of the first key, whichever is
//! nearest to a figure that stands with its arms to the sides.

use glam::{Quat, Vec3};
use ufbx::{RotationOrder, Scene};

use super::nodes::Nodes;
use super::quat;
use crate::humanoid::{Humanoid, Role, Side};
use crate::{Clip, Skeleton};

/// A pose must be better by so much than one that is tried before it, radians.
const CLEARLY: f32 = 0.02;
/// How far arms of a resting figure hang below the horizontal at most, radians.
const LOWEST_ARMS: f32 = 1.2;

/// Translation and rotation of each joint relative to its parent.
type Locals = Vec<(Vec3, Quat)>;

/// Whether a file states its rest pose.
fn is_stated(scene: &Scene) -> bool {
    !scene.skin_clusters.is_empty() || scene.poses.into_iter().any(|pose| pose.is_bind_pose)
}

/// Chooses the rest pose of a figure whose file does not state it, and says which.
pub(super) fn choose(
    scene: &Scene,
    nodes: &Nodes,
    skeleton: &mut Skeleton,
    clips: &[Clip],
) -> Option<String> {
    if is_stated(scene) {
        return None;
    }
    let figure = Humanoid::of_any_skeleton(skeleton);
    let stored: Locals = skeleton.joints.iter().map(|j| (j.translation, j.rotation)).collect();
    let mut unturned = stored.clone();
    for node in &scene.nodes {
        if let Some(joint) = nodes.joint_of_node(node) {
            let of = &node.element.props;
            let post = ufbx::find_prop(of, "PostRotation").filter(|_| node.use_rotation_space);
            let post = post.map_or(Quat::IDENTITY, |prop| {
                let v = prop.value_vec4;
                quat(ufbx::euler_to_quat(ufbx::Vec3 { x: v.x, y: v.y, z: v.z }, RotationOrder::Xyz))
            });
            let turn = quat(ufbx::euler_to_quat(node.euler_rotation, node.rotation_order));
            unturned[joint].1 = (stored[joint].1 * post * turn.conjugate() * post.conjugate()).normalize();
        }
    }
    let mut first = stored.clone();
    for tracks in clips.first().iter().flat_map(|clip| &clip.joints) {
        let (translation, rotation) = &mut first[tracks.joint];
        *translation = tracks.translation.as_ref().map_or(*translation, |track| track.at(0.0));
        *rotation = tracks.rotation.as_ref().map_or(*rotation, |track| track.at(0.0));
    }
    let mut best: Option<(f32, &str, Locals)> = None;
    for (name, pose) in [
        ("that of its nodes", stored.clone()),
        ("that without rotations", unturned),
        ("that of the first key", first),
    ] {
        put(skeleton, &pose);
        if let Some(error) = error(skeleton, &figure)
            && best.as_ref().is_none_or(|(least, ..)| error < least - CLEARLY)
        {
            best = Some((error, name, pose));
        }
    }
    let Some((error, name, pose)) = best else {
        put(skeleton, &stored);
        return None;
    };
    put(skeleton, &pose);
    Some(format!(
        "no skin states a rest pose; {name} is used, whose limbs are {:.0} degrees from a figure with its arms to the sides",
        error.to_degrees()
    ))
}

fn put(skeleton: &mut Skeleton, pose: &[(Vec3, Quat)]) {
    for (joint, &(translation, rotation)) in skeleton.joints.iter_mut().zip(pose) {
        (joint.translation, joint.rotation) = (translation, rotation);
    }
    skeleton.update_rest();
}

/// Mean angle of the limbs and the spine from those of a figure that stands with its arms to the sides, as in a T-pose or an A-pose,
/// radians. `None` for a skeleton that is no figure.
fn error(skeleton: &Skeleton, figure: &Humanoid) -> Option<f32> {
    let at = |role: Role| figure.get(role).map(|joint| skeleton.rest_position(joint));
    let bone = |from: Role, to: Role| (at(to)? - at(from)?).try_normalize();
    let across = at(Role::Thigh(Side::Left))? - at(Role::Thigh(Side::Right))?;
    let left = (across * Vec3::new(1.0, 0.0, 1.0)).try_normalize()?;
    let mut angles = vec![bone(Role::Hips, Role::Head)?.angle_between(Vec3::Y)];
    for side in Side::BOTH {
        let legs = [(Role::Thigh(side), Role::Shin(side)), (Role::Shin(side), Role::Foot(side))];
        let legs = legs.into_iter().filter_map(|(from, to)| bone(from, to));
        angles.extend(legs.map(|bone| bone.angle_between(Vec3::NEG_Y)));
        let out = left * side.sign();
        let arms = [(Role::UpperArm(side), Role::Forearm(side)), (Role::Forearm(side), Role::Hand(side))];
        for bone in arms.into_iter().filter_map(|(from, to)| bone(from, to)) {
            let drop = (-bone.y).atan2(bone.dot(out)).clamp(0.0, LOWEST_ARMS);
            let (sin, cos) = drop.sin_cos();
            angles.push(bone.angle_between(out * cos - Vec3::Y * sin));
        }
    }
    let mean = angles.iter().sum::<f32>() / angles.len() as f32;
    mean.is_finite().then_some(mean)
}
