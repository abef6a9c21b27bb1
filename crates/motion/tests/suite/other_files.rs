//! What other people's files mean: one dance in every format, with the joint names of every family, at any time of the file's clock.

use std::sync::Arc;

use glam::{Quat, Vec3};
use lovelock_motion::{
    Body, Clip, MotionFile, MotionSettings, Pose, load_character, load_motion, load_motion_bytes, pose_at,
    retarget,
};

use crate::common;
use crate::common::dance::{Dance, MIXAMO, Names};
use crate::common::fbx;

fn dancer() -> Option<Arc<Body>> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    if !path.is_file() {
        println!("skipped: no assets/dancer.glb");
        return None;
    }
    Some(load_character(&path).expect("the dancer").body)
}

fn load(name: &str, bytes: &[u8]) -> MotionFile {
    load_motion_bytes(name, bytes, MotionSettings::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The dance in each format that has a clock of its own.
fn written(dance: &Dance) -> [(&'static str, Vec<u8>); 5] {
    [
        ("a.glb", dance.glb()),
        ("a.vrma", dance.vrma()),
        ("a.usda", dance.usda().into_bytes()),
        ("a.fbx", fbx::binary(&dance.fbx())),
        ("b.fbx", fbx::text(&dance.fbx()).into_bytes()),
    ]
}

/// Largest angle between the joints of two clips, radians, and largest distance between their hips on the floor, metres.
fn difference(body: &Body, a: &Clip, b: &Clip, frames: usize) -> (f32, f32) {
    let (mut p, mut q) = (Pose::default(), Pose::default());
    let (mut angle, mut distance) = (0.0_f32, 0.0_f32);
    for frame in 0..frames {
        // The last frame itself would be the first of the next round.
        let secs = (frame as f64 / 30.0 - 1e-5).max(0.0);
        pose_at(body, Some(a), secs, &mut p);
        pose_at(body, Some(b), secs, &mut q);
        for (a, b) in p.world_from_joint.iter().zip(&q.world_from_joint) {
            let turn = Quat::from_mat3a(&a.matrix3)
                .normalize()
                .angle_between(Quat::from_mat3a(&b.matrix3).normalize());
            angle = angle.max(turn);
            let off = Vec3::from(a.translation - b.translation) * Vec3::new(1.0, 0.0, 1.0);
            distance = distance.max(off.length());
        }
    }
    (angle, distance)
}

#[track_caller]
fn assert_same(body: &Body, found: &MotionFile, reference: &Clip, what: &str) {
    let clip = retarget(found, body).unwrap_or_else(|error| panic!("{what}: {error}"));
    let secs = 19.0 / 30.0;
    assert!((clip.duration_secs - secs).abs() < 1e-4, "{what}: {} s", clip.duration_secs);
    let (angle, distance) = difference(body, &clip, reference, 20);
    assert!(angle < 0.02 && distance < 0.01, "{what}: {angle} radians, {distance} m");
}

#[test]
fn every_format_plays_all_keys_from_the_first_on() {
    let Some(body) = dancer() else { return };
    let reference = retarget(&load("a.bvh", Dance::new(&MIXAMO).bvh().as_bytes()), &body).expect("a clip");
    assert!(!reference.loops && (reference.duration_secs - 19.0 * 0.033_333).abs() < 1e-5);
    // At 0, before it, as animations with a pre-roll are written, and seconds after it.
    for first in [0, -25, 150] {
        let dance = Dance { first, ..Dance::new(&MIXAMO) };
        for (name, bytes) in written(&dance) {
            let motion = load(name, &bytes);
            let info = motion.info();
            let (start, end) = (first as f64 / 30.0, (first + 19) as f64 / 30.0);
            assert!(
                (info.start_secs - start).abs() < 1e-4 && (info.end_secs - end).abs() < 1e-4,
                "{name}: {} to {} s for {start} to {end} s",
                info.start_secs,
                info.end_secs
            );
            assert!(!info.loops && info.frames == 39, "{name}: {} frames", info.frames);
            let step = info.key_secs.expect("even keys");
            assert!(
                info.keys == 20 && (step - 1.0 / 30.0).abs() < 1e-5,
                "{name}: {} keys, {step} s",
                info.keys
            );
            assert_same(&body, &motion, &reference, &format!("{name} from frame {first}"));
        }
    }
    // Negative control: another part of the dance is another dance.
    let late = reference.clone().trimmed(0.2, None);
    let (angle, _) = difference(&body, &late, &reference, 10);
    assert!(angle > 0.1, "{angle}");
}

#[test]
fn keys_of_gltf_at_wrong_times_are_named() {
    let whole = Dance::new(&MIXAMO).glb();
    let at = |secs: f32| {
        let bytes = secs.to_le_bytes();
        whole.windows(4).position(|window| window == bytes).expect("a key")
    };
    // The fifth key before the fourth, and a first key decades ago.
    for (key, secs) in [(5.0 / 30.0, 0.05_f32), (1.0 / 30.0, -2e9), (2.0 / 30.0, f32::NAN)] {
        let mut bytes = whole.clone();
        let at = at(key as f32);
        bytes[at..at + 4].copy_from_slice(&secs.to_le_bytes());
        let error = load_motion_bytes("a.glb", &bytes, MotionSettings::default()).expect_err("wrong times");
        let text = error.to_string();
        assert!(text.contains("21 joints and no clip besides 22 channels with keys at times"), "{text}");
    }
}

#[test]
fn a_cycle_without_its_repeated_frame_loops_in_every_format() {
    let Some(body) = dancer() else { return };
    let dance = Dance { frames: 60, cycle: Some(60), ..Dance::new(&MIXAMO) };
    let bvh = ("a.bvh", dance.bvh().into_bytes());
    for (name, bytes) in written(&dance).into_iter().chain([bvh]) {
        let motion = load(name, &bytes);
        let (info, clip) = (motion.info(), retarget(&motion, &body).expect(name));
        assert_eq!((info.keys, info.loops, clip.loops), (60, true, true), "{name}");
        assert!((clip.added_secs - 1.0 / 30.0).abs() < 1e-4, "{name}: {} s", clip.added_secs);
        assert!((clip.duration_secs - 2.0).abs() < 1e-3, "{name}: {} s", clip.duration_secs);
    }
    // The control: three quarters of the cycle are none.
    let dance = Dance { frames: 45, ..dance };
    let clip = retarget(&load("a.glb", &dance.glb()), &body).expect("a clip");
    assert!(!clip.loops && clip.added_secs == 0.0);
}

#[test]
fn a_clip_on_the_clock_of_its_file_is_held_before_its_first_key() {
    let Some(body) = dancer() else { return };
    for (first, secs) in [(150, 5.0 + 19.0 / 30.0), (-10, 9.0 / 30.0)] {
        let motion = load("a.glb", &Dance { first, ..Dance::new(&MIXAMO) }.glb());
        let clip = retarget(&motion, &body).expect("a clip");
        let before = clip.clone().on_file_clock();
        assert!((before.duration_secs - secs).abs() < 1e-4, "{}", before.duration_secs);
        let (mut a, mut b) = (Pose::default(), Pose::default());
        pose_at(&body, Some(&before), 0.1, &mut a);
        pose_at(&body, Some(&clip), (0.1 - first as f64 / 30.0).max(0.0), &mut b);
        let off = a.world_from_joint.iter().zip(&b.world_from_joint);
        let off = off.map(|(a, b)| (a.translation - b.translation).length()).fold(0.0, f32::max);
        assert!(off < 1e-4, "{first}: {off}");
    }
}

/// Families of names, as their programs write them, in the order of the joints.
const FAMILIES: [(&str, &str); 18] = [
    (
        "SMPL",
        "Pelvis, Spine1, Spine3, Neck, Head, L_Collar, L_Shoulder, L_Elbow, L_Wrist, R_Collar, R_Shoulder, R_Elbow, R_Wrist, \
         L_Hip, L_Knee, L_Ankle, L_Foot, R_Hip, R_Knee, R_Ankle, R_Foot",
    ),
    (
        "SMPL of men",
        "m_avg_Pelvis, m_avg_Spine1, m_avg_Spine3, m_avg_Neck, m_avg_Head, m_avg_L_Collar, m_avg_L_Shoulder, m_avg_L_Elbow, \
         m_avg_L_Wrist, m_avg_R_Collar, m_avg_R_Shoulder, m_avg_R_Elbow, m_avg_R_Wrist, m_avg_L_Hip, m_avg_L_Knee, \
         m_avg_L_Ankle, m_avg_L_Foot, m_avg_R_Hip, m_avg_R_Knee, m_avg_R_Ankle, m_avg_R_Foot",
    ),
    (
        "SMPL-X and SMPL-H",
        "pelvis, spine1, spine3, neck, head, left_collar, left_shoulder, left_elbow, left_wrist, right_collar, \
         right_shoulder, right_elbow, right_wrist, left_hip, left_knee, left_ankle, left_foot, right_hip, right_knee, \
         right_ankle, right_foot",
    ),
    (
        "Rokoko",
        "Hips, Spine1, Spine3, Neck, Head, LeftShoulder, LeftArm, LeftForeArm, LeftHand, RightShoulder, RightArm, \
         RightForeArm, RightHand, LeftThigh, LeftShin, LeftFoot, LeftToe, RightThigh, RightShin, RightFoot, RightToe",
    ),
    (
        "Xsens as BVH",
        "Hips, Chest, Chest4, Neck, Head, LeftCollar, LeftShoulder, LeftElbow, LeftWrist, RightCollar, RightShoulder, \
         RightElbow, RightWrist, LeftHip, LeftKnee, LeftAnkle, LeftToe, RightHip, RightKnee, RightAnkle, RightToe",
    ),
    (
        "Xsens as FBX",
        "Pelvis, L5, T8, Neck, Head, LeftShoulder, LeftUpperArm, LeftForeArm, LeftHand, RightShoulder, RightUpperArm, \
         RightForeArm, RightHand, LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToe, RightUpperLeg, RightLowerLeg, RightFoot, \
         RightToe",
    ),
    (
        "Perception Neuron",
        "Robot_Hips, Robot_Spine, Robot_Spine3, Robot_Neck, Robot_Head, Robot_LeftShoulder, Robot_LeftArm, \
         Robot_LeftForeArm, Robot_LeftHand, Robot_RightShoulder, Robot_RightArm, Robot_RightForeArm, Robot_RightHand, \
         Robot_LeftUpLeg, Robot_LeftLeg, Robot_LeftFoot, Robot_LeftToe, Robot_RightUpLeg, Robot_RightLeg, Robot_RightFoot, \
         Robot_RightToe",
    ),
    (
        "OptiTrack",
        "Skeleton 001_Hip, Skeleton 001_Ab, Skeleton 001_Chest, Skeleton 001_Neck, Skeleton 001_Head, \
         Skeleton 001_LShoulder, Skeleton 001_LUArm, Skeleton 001_LFArm, Skeleton 001_LHand, Skeleton 001_RShoulder, \
         Skeleton 001_RUArm, Skeleton 001_RFArm, Skeleton 001_RHand, Skeleton 001_LThigh, Skeleton 001_LShin, \
         Skeleton 001_LFoot, Skeleton 001_LToe, Skeleton 001_RThigh, Skeleton 001_RShin, Skeleton 001_RFoot, \
         Skeleton 001_RToe",
    ),
    (
        "Vicon",
        "pelvis, lowerback, thorax, neck, head, lclavicle, lhumerus, lradius, lhand, rclavicle, rhumerus, rradius, rhand, \
         lfemur, ltibia, lfoot, ltoes, rfemur, rtibia, rfoot, rtoes",
    ),
    (
        "Daz",
        "hip, abdomenLower, chestUpper, neckLower, head, lCollar, lShldrBend, lForearmBend, lHand, rCollar, rShldrBend, \
         rForearmBend, rHand, lThighBend, lShin, lFoot, lToe, rThighBend, rShin, rFoot, rToe",
    ),
    (
        "Character Creator",
        "CC_Base_Hip, CC_Base_Waist, CC_Base_Spine02, CC_Base_NeckTwist01, CC_Base_Head, CC_Base_L_Clavicle, \
         CC_Base_L_Upperarm, CC_Base_L_Forearm, CC_Base_L_Hand, CC_Base_R_Clavicle, CC_Base_R_Upperarm, CC_Base_R_Forearm, \
         CC_Base_R_Hand, CC_Base_L_Thigh, CC_Base_L_Calf, CC_Base_L_Foot, CC_Base_L_ToeBase, CC_Base_R_Thigh, \
         CC_Base_R_Calf, CC_Base_R_Foot, CC_Base_R_ToeBase",
    ),
    (
        "Unreal",
        "pelvis, spine_01, spine_03, neck_01, head, clavicle_l, upperarm_l, lowerarm_l, hand_l, clavicle_r, upperarm_r, \
         lowerarm_r, hand_r, thigh_l, calf_l, foot_l, ball_l, thigh_r, calf_r, foot_r, ball_r",
    ),
    (
        "Unity",
        "Hip, Spine, Ribs, Neck, Head, Left_Shoulder_Joint_01, Left_Upper_Arm_Joint_01, Left_Forearm_Joint_01, \
         Left_Wrist_Joint_01, Right_Shoulder_Joint_01, Right_Upper_Arm_Joint_01, Right_Forearm_Joint_01, \
         Right_Wrist_Joint_01, Left_Thigh_Joint_01, Left_Knee_Joint_01, Left_Ankle_Joint_01, Left_Toe_Joint_01, \
         Right_Thigh_Joint_01, Right_Knee_Joint_01, Right_Ankle_Joint_01, Right_Toe_Joint_01",
    ),
    (
        "MakeHuman",
        "root, spine05, spine01, neck01, head, clavicle.L, upperarm01.L, lowerarm01.L, wrist.L, clavicle.R, upperarm01.R, \
         lowerarm01.R, wrist.R, upperleg01.L, lowerleg01.L, foot.L, toe1-1.L, upperleg01.R, lowerleg01.R, foot.R, toe1-1.R",
    ),
    (
        "Biped",
        "Bip01 Pelvis, Bip01 Spine, Bip01 Spine2, Bip01 Neck, Bip01 Head, Bip01 L Clavicle, Bip01 L UpperArm, \
         Bip01 L Forearm, Bip01 L Hand, Bip01 R Clavicle, Bip01 R UpperArm, Bip01 R Forearm, Bip01 R Hand, Bip01 L Thigh, \
         Bip01 L Calf, Bip01 L Foot, Bip01 L Toe0, Bip01 R Thigh, Bip01 R Calf, Bip01 R Foot, Bip01 R Toe0",
    ),
    (
        "Kinect",
        "PELVIS, SPINE_NAVEL, SPINE_CHEST, NECK, HEAD, CLAVICLE_LEFT, SHOULDER_LEFT, ELBOW_LEFT, WRIST_LEFT, CLAVICLE_RIGHT, \
         SHOULDER_RIGHT, ELBOW_RIGHT, WRIST_RIGHT, HIP_LEFT, KNEE_LEFT, ANKLE_LEFT, FOOT_LEFT, HIP_RIGHT, KNEE_RIGHT, \
         ANKLE_RIGHT, FOOT_RIGHT",
    ),
    (
        "MikuMikuDance",
        "センター, 上半身, 上半身2, 首, 頭, 左肩, 左腕, 左ひじ, 左手首, 右肩, 右腕, 右ひじ, 右手首, 左足, 左ひざ, 左足首, 左つま先, 右足, 右ひざ, 右足首, 右つま先",
    ),
    // The shape tells the limbs, and the toes tell the front.
    ("no names", "a, b, c, d, e, f, g, h, i, j, k, m, n, o, p, q, s, t, u, v, w"),
];

fn names_of(family: &'static str) -> Names {
    let mut names = family.split(", ");
    std::array::from_fn(|_| names.next().expect("21 names"))
}

#[test]
fn every_family_of_names_dances_alike() {
    let Some(body) = dancer() else { return };
    let reference = retarget(&load("a.bvh", Dance::new(&MIXAMO).bvh().as_bytes()), &body).expect("a clip");
    for (i, (family, names)) in FAMILIES.into_iter().enumerate() {
        let names = names_of(names);
        let dance = Dance::new(&names);
        assert_same(&body, &load("a.bvh", dance.bvh().as_bytes()), &reference, family);
        // In another format by turns.
        let others = [
            ("a.glb", dance.glb()),
            ("a.usda", dance.usda().into_bytes()),
            ("a.fbx", fbx::binary(&dance.fbx())),
        ];
        let (name, bytes) = &others[i % others.len()];
        // Names of USD are paths, in which only some letters are allowed.
        let is_path = |name: &&str| name.is_ascii() && !name.contains([' ', '.', '-']);
        if *name != "a.usda" || names.iter().all(is_path) {
            let motion = load(name, bytes);
            assert_same(&body, &motion, &reference, &format!("{family} as {name}"));
            let by_shape = motion.notes.iter().any(|note| note.contains("shape of the skeleton"));
            assert_eq!(by_shape, family == "no names", "{family}: {:?}", motion.notes);
        }
    }
    // Negative control: with the names of both arms exchanged it is another dance.
    let mut wrong = MIXAMO;
    wrong.swap(6, 10);
    wrong.swap(7, 11);
    let clip = retarget(&load("a.bvh", Dance::new(&wrong).bvh().as_bytes()), &body).expect("a clip");
    assert!(difference(&body, &clip, &reference, 20).0 > 0.1);
    let Some(data) = common::data_dir() else { return };
    let of = |name: &str| {
        retarget(&load_motion(&data.join("reports").join(name)).expect(name), &body).expect(name)
    };
    let reference = of("mixamo_names_reference.bvh");
    for name in ["smpl_names.bvh", "m_avg_names.bvh"] {
        let (angle, distance) = difference(&body, &of(name), &reference, 60);
        assert!(angle < 1e-3 && distance < 1e-4, "{name}: {angle} radians, {distance} m");
    }
}

#[test]
fn a_file_without_a_skin_rests_in_the_pose_nearest_to_a_standing_figure() {
    // The nodes stand in the middle of the dance; without rotations they are in a T-pose.
    let motion = load("a.fbx", &fbx::binary(&Dance::new(&MIXAMO).fbx()));
    assert!(motion.notes.iter().any(|note| note.contains("that without rotations")), "{:?}", motion.notes);
    let rest = motion.rest();
    let at = |name: &str| rest[motion.joints.iter().position(|j| j.name == name).expect(name)];
    let arm = at("LeftHand") - at("LeftArm");
    assert!(arm.normalize_or_zero().distance(Vec3::X) < 1e-3, "{arm}");
    // Where joints have axes of their own, zero rotations are no pose of a figure, but the first key is a T-pose.
    let turned = load("a.fbx", &fbx::binary(&Dance { own_axes: true, ..Dance::new(&MIXAMO) }.fbx()));
    assert!(turned.notes.iter().any(|note| note.contains("that of the first key")), "{:?}", turned.notes);
    let Some(body) = dancer() else { return };
    let reference = retarget(&load("a.bvh", Dance::new(&MIXAMO).bvh().as_bytes()), &body).expect("a clip");
    assert_same(&body, &turned, &reference, "joints with axes of their own");
}
