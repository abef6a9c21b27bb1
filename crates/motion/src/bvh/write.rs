//! Writes a clip as a BVH file.

use std::fmt::Write as _;

use glam::{EulerRot, Quat, Vec3};

use crate::{Body, Clip, Pose, pose_at};

/// Centimetres per metre: most BVH files are in centimetres.
const CM: f32 = 100.0;

/// The deepest joint that is written, counted from the first.
const MAX_DEPTH: usize = 500;

/// The largest number of frames.
const MAX_FRAMES: usize = 100_000;

/// A clip of a body as the text of a BVH file, in centimetres with Y up, `fps` frames per second from the first key to the last. Joints
/// that are not below the first one, scales and morph targets are left out. The text is empty if the body has no joints.
///
/// BVH has no rotations at rest, so those of a frame are relative to the rest pose in the axes of the world: with `W` the world rotation of a
/// joint and `P` that of its parent, `(P rest(P)^-1)^-1 (W rest(W)^-1)`.
pub fn write_bvh(body: &Body, clip: &Clip, fps: f64) -> String {
    let skeleton = &body.skeleton;
    let mut text = String::new();
    if skeleton.joints.is_empty() {
        return text;
    }
    text.push_str("HIERARCHY\n");
    let mut order = Vec::new();
    joint(body, 0, 0, &mut text, &mut order);
    let fps = if fps.is_finite() { fps.clamp(1.0, 1000.0) } else { 30.0 };
    let frames = ((clip.duration_secs * fps).round().max(0.0) as usize + 1).min(MAX_FRAMES);
    let _ = write!(text, "MOTION\nFrames: {frames}\nFrame Time: {:.6}\n", 1.0 / fps);
    let rest: Vec<Quat> = skeleton.world_at_rest.iter().map(|at| rotation(&at.matrix3)).collect();
    let mut pose = Pose::default();
    for frame in 0..frames {
        pose_at(body, Some(clip), frame as f64 / fps, &mut pose);
        let turned: Vec<Quat> = pose
            .world_from_joint
            .iter()
            .zip(&rest)
            .map(|(at, rest)| rotation(&at.matrix3) * rest.inverse())
            .collect();
        let root = Vec3::from(pose.world_from_joint[0].translation) * CM;
        let _ = write!(text, "{:.4} {:.4} {:.4}", root.x, root.y, root.z);
        for &at in &order {
            let parent = skeleton.joints[at].parent.filter(|_| at > 0);
            let local = parent.map_or(turned[at], |parent| turned[parent].inverse() * turned[at]);
            let (z, x, y) = local.to_euler(EulerRot::ZXY);
            let [z, x, y] = [z, x, y].map(f32::to_degrees);
            let _ = write!(text, " {z:.4} {x:.4} {y:.4}");
        }
        text.push('\n');
    }
    text
}

fn rotation(matrix: &glam::Mat3A) -> Quat {
    crate::pose::rotation_of(matrix)
}

/// Writes a joint and those below it, and lists them in their order.
fn joint(body: &Body, at: usize, depth: usize, text: &mut String, order: &mut Vec<usize>) {
    let skeleton = &body.skeleton;
    let indent = "\t".repeat(depth);
    let place = skeleton.rest_position(at);
    let parent = skeleton.joints[at].parent.filter(|_| depth > 0);
    let offset = (place - parent.map_or(Vec3::ZERO, |parent| skeleton.rest_position(parent))) * CM;
    let name: String = skeleton.joints[at]
        .name
        .chars()
        .map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c })
        .collect();
    let (kind, channels) = if depth == 0 {
        ("ROOT", "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation")
    } else {
        ("JOINT", "3 Zrotation Xrotation Yrotation")
    };
    let _ = writeln!(text, "{indent}{kind} {name}");
    let _ = writeln!(text, "{indent}{{");
    let _ = writeln!(text, "{indent}\tOFFSET {:.4} {:.4} {:.4}", offset.x, offset.y, offset.z);
    let _ = writeln!(text, "{indent}\tCHANNELS {channels}");
    order.push(at);
    if depth > MAX_DEPTH {
        let _ = writeln!(text, "{indent}}}");
        return;
    }
    let below: Vec<usize> =
        (at + 1..skeleton.joints.len()).filter(|&child| skeleton.joints[child].parent == Some(at)).collect();
    for &child in &below {
        joint(body, child, depth + 1, text, order);
    }
    if below.is_empty() {
        let _ = writeln!(text, "{indent}\tEnd Site\n{indent}\t{{\n{indent}\t\tOFFSET 0 4 0\n{indent}\t}}");
    }
    let _ = writeln!(text, "{indent}}}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Joint, MotionSettings, Skeleton, load_motion_bytes};

    #[test]
    fn a_body_that_does_not_move_is_read_without_rotations() {
        let mut skeleton = Skeleton {
            joints: [
                ("hips", None, [0.0, 0.95, 0.0]),
                ("spine", Some(0), [0.0, 0.4, 0.02]),
                ("head", Some(1), [0.0, 0.2, 0.0]),
            ]
            .into_iter()
            .map(|(name, parent, at)| Joint {
                name: name.to_owned(),
                parent,
                translation: Vec3::from(at),
                // Joints have axes of their own at rest.
                rotation: Quat::from_rotation_x(0.3),
                scale: Vec3::ONE,
            })
            .collect(),
            ..Skeleton::default()
        };
        skeleton.update_rest();
        let body = Body { skeleton, ..Body::default() };
        let text = write_bvh(&body, &Clip { duration_secs: 0.5, ..Clip::default() }, 10.0);
        assert!(text.contains("Frames: 6\n"), "{text}");
        let motion =
            load_motion_bytes("still.bvh", text.as_bytes(), MotionSettings::default()).expect("reads");
        assert_eq!(motion.joints.len(), 3);
        // Nothing moves: no rotation, and the offsets are those of the rest pose.
        assert!(motion.rotations.iter().all(|turn| turn.angle_between(Quat::IDENTITY) < 1e-3));
    }

    #[test]
    fn a_body_without_joints_gives_no_text() {
        assert_eq!(write_bvh(&Body::default(), &Clip::default(), 30.0), "");
    }
}
