//! A motion file: the shipped dance as BVH, as motion capture is passed on.

use lovelock_motion::write_bvh;
use lovelock_project::error::ProjectError;
use lovelock_session::scene::dancer;

/// Frames per second, a common rate of motion capture.
const FPS: f64 = 60.0;

/// The name of the clip.
const CLIP: &str = "dance";

/// The clip as the text of a BVH file.
pub(super) fn clip() -> Result<String, ProjectError> {
    let figure = dancer().map_err(|error| ProjectError::work(error.to_string()))?;
    let clip = figure.clips.iter().find(|clip| clip.name == CLIP).or(figure.clips.first());
    let clip = clip.ok_or_else(|| ProjectError::work("the shipped dancer has no clip".to_owned()))?;
    Ok(write_bvh(&figure.body, clip, FPS))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use lovelock_motion::{MotionSettings, Pose, load_motion_bytes, pose_at};

    use super::*;

    #[test]
    fn the_file_has_every_joint_where_the_dance_has_it() {
        let figure = dancer().expect("loads");
        let clip = figure.clips.iter().find(|clip| clip.name == CLIP).expect("the dance");
        let text = super::clip().expect("is written");
        let motion =
            load_motion_bytes("dance.bvh", text.as_bytes(), MotionSettings::default()).expect("reads");
        assert!((motion.unit_metres - 0.01).abs() < 1e-6, "{}", motion.unit_metres);
        let (mut pose, mut world) = (Pose::default(), Vec::new());
        let mut largest = 0.0_f32;
        for frame in [0, 30, 151, 400] {
            pose_at(&figure.body, Some(clip), frame as f64 / FPS, &mut pose);
            motion.world(frame, &mut world);
            for (joint, at) in motion.joints.iter().zip(&world) {
                let same = figure.body.skeleton.joints.iter().position(|known| known.name == joint.name);
                let wanted = Vec3::from(pose.world_from_joint[same.expect("the joint")].translation);
                largest = largest.max(wanted.distance(at.translation.into()));
            }
        }
        assert!(largest < 0.003, "{largest} m");
    }
}
