//! Clips against analytic solutions: interpolation, wrapping, cross-fading, the rigid head.

use crate::common;

use std::{f32::consts::FRAC_PI_2, sync::Arc};

use glam::{Quat, Vec3};
use lovelock_motion::{
    Body, Clip, Interpolation, Joint, JointTracks, LoopBlend, Pose, Skeleton, Track, load_character, pose_at,
};

fn track<T>(times: &[f32], values: Vec<T>, interpolation: Interpolation) -> Track<T> {
    Track { times: Arc::from(times), values, interpolation }
}

/// Two joints, one a metre above the other; the upper one is the head, scaled by 3.
fn body() -> Body {
    let joint = |name: &str, parent, y, scale| Joint {
        name: name.into(),
        parent,
        translation: Vec3::Y * y,
        rotation: Quat::IDENTITY,
        scale: Vec3::splat(scale),
    };
    let mut skeleton = Skeleton {
        joints: vec![joint("hips", None, 1.0, 1.0), joint("head", Some(0), 1.0, 3.0)],
        ..Skeleton::default()
    };
    skeleton.update_rest();
    Body { name: "two".into(), skeleton, head_joint: 1, ..Body::default() }
}

fn moving(translation: Track<Vec3>) -> Clip {
    let joints = vec![JointTracks { joint: 0, translation: Some(translation), ..JointTracks::default() }];
    let mut clip = Clip { name: "moving".into(), joints, ..Clip::default() };
    clip.duration_secs = clip.keys_end_secs();
    clip
}

fn place(clip: &Clip, time: f64) -> Vec3 {
    let mut pose = Pose::default();
    pose_at(&body(), Some(clip), time, &mut pose);
    pose.world_from_joint[0].translation.into()
}

#[test]
fn step_holds_and_linear_is_straight() {
    let step = moving(track(&[0.0, 1.0, 3.0], vec![Vec3::ZERO, Vec3::X, Vec3::Y], Interpolation::Step));
    for (time, at) in
        [(0.0, Vec3::ZERO), (0.999, Vec3::ZERO), (1.0, Vec3::X), (2.999, Vec3::X), (3.0, Vec3::ZERO)]
    {
        assert_eq!(place(&step, time), at, "{time}");
    }
    let linear = moving(track(&[0.0, 1.0, 3.0], vec![Vec3::ZERO, Vec3::X, Vec3::Y], Interpolation::Linear));
    assert_eq!(place(&linear, 0.25), Vec3::X * 0.25);
    assert_eq!(place(&linear, 2.0), Vec3::new(0.5, 0.5, 0.0));
    // It repeats, also for negative and large times.
    assert!(place(&linear, -2.75).distance(Vec3::X * 0.25) < 1e-6);
    assert!(place(&linear, 3000.25).distance(Vec3::X * 0.25) < 1e-5);
    assert_eq!(place(&linear, f64::NAN), Vec3::ZERO);
}

#[test]
fn cubic_follows_its_polynomial() {
    // x(t) = t^3 on 0..2 and beyond: slopes 0, 12, 27 at 0, 2, 3. A Hermite spline reproduces any cubic
    // exactly.
    let value = |x: f32| Vec3::X * x;
    let (v, s): (Vec<f32>, Vec<f32>) = [0.0_f32, 2.0, 3.0].iter().map(|t| (t * t * t, 3.0 * t * t)).unzip();
    let values = (0..3).flat_map(|k| [value(s[k]), value(v[k]), value(s[k])]).collect();
    let clip = moving(track(&[0.0, 2.0, 3.0], values, Interpolation::Cubic));
    for k in 0..30 {
        let t = 0.1 * k as f32;
        assert!((place(&clip, f64::from(t)).x - t * t * t).abs() < 2e-5, "{t}");
    }
    // Negative control: tangents not scaled by the key spacing miss the cubic.
    assert!((place(&clip, 1.0).x - 1.0).abs() < 1e-5);
    assert!((0.5 * 8.0 - 0.125 * 12.0_f32 - 1.0).abs() > 1.0);
}

#[test]
fn rotations_take_the_shorter_arc() {
    let turn = |angle: f32| Quat::from_rotation_y(angle);
    // The second key is the same rotation with the opposite sign.
    let rotation = track(&[0.0, 1.0], vec![turn(0.0), -turn(FRAC_PI_2)], Interpolation::Linear);
    let joints = vec![JointTracks { joint: 0, rotation: Some(rotation), ..JointTracks::default() }];
    let clip = Clip { joints, duration_secs: 1.0, ..Clip::default() };
    let mut pose = Pose::default();
    pose_at(&body(), Some(&clip), 0.5, &mut pose);
    let expected = turn(FRAC_PI_2 / 2.0) * Vec3::X;
    assert!(pose.world_from_joint[0].transform_vector3(Vec3::X).distance(expected) < 1e-6);
    // The head is rigid although its joint is scaled by 3, and is at the position of the joint.
    assert!(pose.world_from_head.transform_vector3(Vec3::X).distance(expected) < 1e-5);
    assert!(pose.world_from_head.transform_point3(Vec3::ZERO).distance(Vec3::Y * 2.0) < 1e-6);
}

#[test]
fn a_pose_is_reused_without_allocation() {
    let clip = moving(track(&[0.0, 1.0], vec![Vec3::ZERO, Vec3::X], Interpolation::Linear));
    let (body, mut pose) = (body(), Pose::default());
    pose_at(&body, Some(&clip), 0.0, &mut pose);
    let before = (pose.world_from_joint.as_ptr(), pose.world_from_joint.capacity());
    pose_at(&body, Some(&clip), 0.7, &mut pose);
    assert_eq!(before, (pose.world_from_joint.as_ptr(), pose.world_from_joint.capacity()));
}

#[test]
fn a_cross_faded_clip_repeats_without_a_jump() {
    let open =
        moving(track(&[0.0, 1.0, 2.0], vec![Vec3::ZERO, Vec3::X, Vec3::X * 4.0], Interpolation::Linear));
    let jump = |clip: &Clip| {
        let end = clip.duration_secs;
        place(clip, end - 1e-4).distance(place(clip, end + 1e-4))
    };
    // Negative control: without the cross-fade it jumps by 4 m.
    assert!(jump(&open) > 3.9);
    let faded = open.clone().with_loop_blend(0.5, LoopBlend::Start);
    assert!(faded.loops && (faded.duration_secs - 1.5).abs() < 1e-12);
    assert!(jump(&faded) < 2e-3, "{}", jump(&faded));
    // Outside the cross-fade the clip is unchanged.
    assert_eq!(place(&faded, 0.75), place(&open, 0.75));
    let again = faded.with_loop_blend(0.0, LoopBlend::Start);
    assert_eq!(again.duration_secs, 2.0);
}

#[test]
fn a_blend_at_the_end_keeps_all_poses_before_it_and_the_length() {
    let open =
        moving(track(&[0.0, 1.0, 2.0], vec![Vec3::X, Vec3::ZERO, Vec3::X * 4.0], Interpolation::Linear));
    let blended = open.clone().with_loop_blend(0.5, LoopBlend::End);
    assert!(blended.loops && blended.duration_secs == 2.0);
    for secs in [0.0, 0.1, 0.4, 1.0, 1.5] {
        assert_eq!(place(&blended, secs), place(&open, secs), "{secs}");
    }
    assert!(place(&blended, 1.75).distance(Vec3::X * 2.0) < 1e-6, "half way to the first pose");
    let jump = place(&blended, 2.0 - 1e-4).distance(place(&blended, 2.0 + 1e-4));
    assert!(jump < 2e-3, "{jump}");
    let once = blended.played_once();
    assert!(place(&once, 2.0_f64.next_down()).distance(Vec3::X * 4.0) < 1e-6, "the last pose");
    assert!(!once.loops);
}

#[test]
fn real_looping_clips_are_detected() {
    let Some(data) = common::data_dir() else { return };
    let load = |file: &str| load_character(&data.join("characters").join(file)).unwrap();
    let robot = load("robot.glb");
    let loops = |name: &str| robot.clips.iter().find(|c| c.name == name).unwrap().loops;
    assert!(loops("Robot_Dance") && loops("Robot_Walking") && loops("Robot_Running"));
    assert!(!loops("Robot_Death") && !loops("Robot_Sitting"));
    let dance = robot.clips.iter().find(|c| c.name == "Robot_Dance").unwrap();
    assert!((dance.duration_secs - 3.33).abs() < 0.05, "{}", dance.duration_secs);
}

#[test]
fn cubic_and_step_versions_of_a_walk_agree_at_its_keys() {
    let Some(data) = common::data_dir() else { return };
    let fox = load_character(&data.join("characters/Fox_cubicspline_step.glb")).unwrap();
    let clip = |name: &str| fox.clips.iter().find(|c| c.name == name).unwrap();
    let (linear, cubic, step) = (clip("Walk"), clip("Walk_CUBICSPLINE"), clip("Walk_STEP"));
    let (mut a, mut b) = (Pose::default(), Pose::default());
    let worst = |a: &Pose, b: &Pose| {
        let pairs = a.world_from_joint.iter().zip(&b.world_from_joint);
        pairs.map(|(a, b)| Vec3::from(a.translation - b.translation).length()).fold(0.0_f32, f32::max)
    };
    let times = linear.joints.iter().find_map(|j| j.rotation.as_ref()).unwrap().times.clone();
    for &t in times.iter().take(times.len() - 1) {
        pose_at(&fox.body, Some(linear), f64::from(t), &mut a);
        pose_at(&fox.body, Some(cubic), f64::from(t), &mut b);
        assert!(worst(&a, &b) < 1e-4, "cubic at {t}: {}", worst(&a, &b));
        pose_at(&fox.body, Some(step), f64::from(t), &mut b);
        assert!(worst(&a, &b) < 1e-4, "step at {t}: {}", worst(&a, &b));
    }
}

#[test]
fn a_trimmed_clip_is_a_part_of_the_whole_one() {
    let times: Vec<f32> = (0..=8).map(|i| 0.5 * i as f32).collect();
    let values = times.iter().map(|&t| Vec3::new(t, 0.0, 0.0)).collect();
    let clip = moving(Track { times: times.into(), values, interpolation: Interpolation::Linear });
    let body = body();
    let x = |clip: &Clip, secs: f64| {
        let mut pose = Pose::default();
        pose_at(&body, Some(clip), secs, &mut pose);
        pose.world_from_joint[0].translation.x
    };
    let start = x(&clip, 0.0);
    let part = clip.clone().trimmed(1.0, Some(3.0));
    assert_eq!((part.duration_secs, part.keys_end_secs()), (2.0, 4.0));
    for secs in [0.0, 0.3, 1.0, 1.99] {
        assert!((x(&part, secs) - start - (1.0 + secs) as f32).abs() < 1e-5, "{secs}");
    }
    assert!((x(&part, 2.0) - x(&part, 0.0)).abs() < 1e-5, "it repeats");
    // With its end cross-faded into its start it reads only keys of the range.
    let faded = part.with_loop_blend(0.5, LoopBlend::Start);
    assert_eq!(faded.duration_secs, 1.5);
    assert!((x(&faded, 0.0) - start - 2.5).abs() < 1e-5, "the round starts in the tail");
    assert!((x(&faded, 0.5) - start - 1.5).abs() < 1e-5, "the tail has no effect after the cross-fade");
    // Invalid ranges are limited to the keys.
    for (from, to) in [(f64::NAN, None), (9.0, Some(1.0)), (-3.0, Some(f64::INFINITY)), (3.0, Some(2.0))] {
        let odd = clip.clone().trimmed(from, to);
        let [first, last] = odd.part();
        assert!(first >= 0.0 && last <= 4.0 && odd.duration_secs >= 0.0999, "{from} {to:?}: {first} {last}");
    }
}
