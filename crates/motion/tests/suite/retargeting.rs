//! Real motions on real bodies: head up, feet on the ground, facing the viewer, plausible limbs.

use crate::common;

use std::path::Path;

use glam::{Quat, Vec3};
use lovelock_motion::{
    Body, Clip, LoopBlend, MotionError, Pose, Skin, load_character, load_motion, pose_at, retarget, skin,
};

/// Measurements over a clip.
struct Measures {
    /// Fraction of frames with the head more than a fifth of the height above the hips.
    head_up: f32,
    /// Fraction of frames whose lowest vertex is within 3 cm of the ground.
    grounded: f32,
    /// Lowest vertex of all frames, metres.
    lowest: f32,
    /// Fraction of frames whose knees bend forward or not at all.
    knees: f32,
    /// Angle between the hips' front and +Z at the start, degrees.
    start_turn: f32,
}

fn joint(body: &Body, names: &[&str]) -> usize {
    let found = names.iter().find_map(|n| body.skeleton.joints.iter().position(|j| j.name == *n));
    found.unwrap_or_else(|| panic!("no {names:?}"))
}

fn measure(body: &Body, clip: &Clip) -> Measures {
    let (mut pose, mut surface) = (Pose::default(), Skin::default());
    let hips = joint(body, &["hips", "root"]);
    let legs = [("l", "L"), ("r", "R")].map(|(a, b)| {
        let find = |x: &str, y: &str| joint(body, &[&format!("{x}_{a}"), &format!("{y}.{b}")]);
        [find("thigh", "upperleg01"), find("shin", "lowerleg01"), find("foot", "foot")]
    });
    let frames = (clip.duration_secs * 30.0).max(1.0) as usize;
    let mut m = Measures { head_up: 0.0, grounded: 0.0, lowest: f32::MAX, knees: 0.0, start_turn: 0.0 };
    let share = 1.0 / frames as f32;
    for frame in 0..frames {
        pose_at(body, Some(clip), frame as f64 / 30.0, &mut pose);
        skin(body, &pose, &mut surface);
        let at = |j: usize| Vec3::from(pose.world_from_joint[j].translation);
        let lowest = surface.positions.iter().map(|p| p.y).fold(f32::MAX, f32::min);
        let above = at(body.head_joint).y - at(hips).y;
        m.head_up += if above > 0.2 * body.height() { share } else { 0.0 };
        m.grounded += if lowest.abs() < 0.03 { share } else { 0.0 };
        m.lowest = m.lowest.min(lowest);
        // The front of a thigh is the front of the hips, moved with the thigh.
        let fine = legs.iter().all(|&[thigh, shin, foot]| {
            let rest = body.skeleton.world_at_rest[thigh];
            let front = (pose.world_from_joint[thigh] * rest.inverse()).transform_vector3(Vec3::Z);
            let upper = (at(shin) - at(thigh)).normalize_or_zero();
            let lower = (at(foot) - at(shin)).normalize_or_zero();
            // A shin bent to the front of its thigh by more than 20 degrees is a broken knee.
            (lower - upper * lower.dot(upper)).dot(front) < 0.35
        });
        m.knees += if fine { share } else { 0.0 };
        if frame == 0 {
            let rest = body.skeleton.world_at_rest[hips];
            let front = (pose.world_from_joint[hips] * rest.inverse()).transform_vector3(Vec3::Z);
            m.start_turn = front.x.atan2(front.z).to_degrees().abs();
        }
    }
    m
}

fn bodies(data: &Path) -> Vec<std::sync::Arc<Body>> {
    let dancer = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    let mut files = vec![data.join("characters/mh_body.glb")];
    if dancer.is_file() {
        files.push(dancer);
    } else {
        println!("skipped: no assets/dancer.glb");
    }
    files.iter().map(|f| load_character(f).unwrap().body).collect()
}

#[test]
fn motions_stand_on_the_ground_with_the_head_up() {
    let Some(data) = common::data_dir() else { return };
    for body in bodies(&data) {
        // The dance hops twice per second, with both feet in the air for nearly half of the time: the hips
        // rise by 0.2 m in 0.2 s, as in free flight. Boxing_Toes sits down at its end, so the limit for its
        // head is lower.
        for (file, head_up, grounded) in [
            ("jesse_dance", 1.0, 0.42),
            ("cmu1_jumping_jacks", 1.0, 0.8),
            ("fair1_dab", 0.98, 0.9),
            ("mh_walk1", 1.0, 0.9),
            ("assimp_Boxing_Toes", 0.7, 0.8),
        ] {
            let motion = load_motion(&data.join("motion").join(file).with_extension("bvh")).unwrap();
            let clip = retarget(&motion, &body).unwrap();
            let m = measure(&body, &clip);
            println!(
                "{} {file}: head up {:.2}, grounded {:.2}, lowest {:.3} m, knees {:.2}, turned {:.1}°",
                body.name, m.head_up, m.grounded, m.lowest, m.knees, m.start_turn
            );
            assert!(m.head_up >= head_up - 1e-3, "{file}");
            assert!(m.grounded >= grounded, "{file}");
            assert!(m.knees > 0.97, "{file}");
            assert!(m.start_turn < 1.0, "{file}");
        }
    }
}

#[test]
fn a_cycle_without_its_repeated_frame_loops() {
    let Some(data) = common::data_dir() else { return };
    let body = load_character(&data.join("characters/mh_body.glb")).unwrap().body;
    let walk = retarget(&load_motion(&data.join("motion/mh_walk1.bvh")).unwrap(), &body).unwrap();
    assert!(walk.loops && (walk.duration_secs - 14.0 * 0.041_667).abs() < 1e-4, "{}", walk.duration_secs);
    let dab = retarget(&load_motion(&data.join("motion/fair1_dab.bvh")).unwrap(), &body).unwrap();
    assert!(!dab.loops);
    let faded = dab.with_loop_blend(0.5, LoopBlend::End);
    let (mut before, mut after) = (Pose::default(), Pose::default());
    pose_at(&body, Some(&faded), faded.duration_secs - 1e-3, &mut before);
    pose_at(&body, Some(&faded), faded.duration_secs + 1e-3, &mut after);
    for (a, b) in before.world_from_joint.iter().zip(&after.world_from_joint) {
        // Two milliseconds at 10 m/s.
        assert!(Vec3::from(a.translation - b.translation).length() < 0.02);
    }
}

#[test]
fn a_pose_of_the_same_rig_is_reproduced() {
    let Some(data) = common::data_dir() else { return };
    let body = load_character(&data.join("characters/mh_body.glb")).unwrap().body;
    let pose_file = load_motion(&data.join("motion/mh_tpose.bvh")).unwrap();
    let clip = retarget(&pose_file, &body).unwrap();
    let (mut pose, mut world) = (Pose::default(), Vec::new());
    pose_at(&body, Some(&clip), 0.0, &mut pose);
    pose_file.world(0, &mut world);
    // The rigs divide limbs into two bones, of which the chord is aligned.
    for (from, to) in [
        ("upperarm01.L", "lowerarm01.L"),
        ("lowerarm01.R", "wrist.R"),
        ("upperleg01.L", "lowerleg01.L"),
        ("lowerleg01.R", "foot.R"),
    ] {
        let of_body = |name: &str| Vec3::from(pose.world_from_joint[joint(&body, &[name])].translation);
        let of_file = |name: &str| {
            Vec3::from(world[pose_file.joints.iter().position(|j| j.name == name).unwrap()].translation)
        };
        let angle = (of_body(to) - of_body(from)).angle_between(of_file(to) - of_file(from)).to_degrees();
        // Both files round to six digits; the second bone of a limb may rotate slightly relative to the
        // first.
        assert!(angle < 3.0, "{from} {angle}°");
    }
}

#[test]
fn figures_that_do_not_correspond_are_refused() {
    let Some(data) = common::data_dir() else { return };
    let motion = load_motion(&data.join("motion/mh_walk1.bvh")).unwrap();
    let fox = load_character(&data.join("characters/Fox.glb")).unwrap();
    let error = retarget(&motion, &fox.body).unwrap_err();
    assert!(
        matches!(error, MotionError::Retarget { .. }) && error.to_string().contains("of the body"),
        "{error}"
    );
}

#[test]
fn a_body_without_a_named_head_is_told_by_its_shape() {
    let Some(data) = common::data_dir() else { return };
    let motion = load_motion(&data.join("motion/mh_walk1.bvh")).unwrap();
    let man = load_character(&data.join("characters/CesiumMan.glb")).unwrap().body;
    let clip = retarget(&motion, &man).unwrap();
    let (mut pose, mut moved) = (Pose::default(), 0.0_f32);
    for k in 0..14 {
        pose_at(&man, Some(&clip), f64::from(k) * motion.frame_secs, &mut pose);
        let heights = pose.world_from_joint.iter().map(|world| world.translation.y / man.height());
        let lowest = heights.fold(f32::MAX, f32::min);
        let head = pose.world_from_joint[man.head_joint].translation;
        assert!(head.y > 0.75 * man.height() && (-0.05..0.2).contains(&lowest), "{k}: {head}, {lowest}");
        let feet = pose.world_from_joint.iter().map(|world| (world.translation - head).z);
        moved = moved.max(feet.fold(0.0, f32::max));
    }
    assert!(moved > 0.05 * man.height(), "it walks: {moved}");
}

/// Joints of the dancer whose motion every figure has.
const LIMBS: [&str; 13] = [
    "hips",
    "head",
    "upper_arm_l",
    "upper_arm_r",
    "forearm_l",
    "forearm_r",
    "hand_l",
    "hand_r",
    "thigh_l",
    "thigh_r",
    "shin_l",
    "shin_r",
    "foot_l",
];

#[test]
fn a_clip_of_one_character_moves_another() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    let dancer = load_character(&path).unwrap();
    let motion = load_motion(&path).unwrap();
    assert_eq!(motion.name, dancer.clips[0].name);
    // On its own figure it is the same, up to the direction of the start.
    let clip = retarget(&motion, &dancer.body).unwrap();
    let limbs = LIMBS.map(|name| joint(&dancer.body, &[name]));
    let (mut own, mut again) = (Pose::default(), Pose::default());
    let turn =
        |pose: &Pose, joint: usize| Quat::from_mat3a(&pose.world_from_joint[joint].matrix3).normalize();
    let at = |secs: f64, own: &mut Pose, again: &mut Pose| {
        pose_at(&dancer.body, Some(&dancer.clips[0]), secs, own);
        pose_at(&dancer.body, Some(&clip), secs, again);
    };
    at(0.0, &mut own, &mut again);
    let start = turn(&again, limbs[0]) * turn(&own, limbs[0]).conjugate();
    let mut moved = 0.0_f32;
    for k in 0..40 {
        at(f64::from(k) * 0.21, &mut own, &mut again);
        for (limb, name) in limbs.into_iter().zip(LIMBS) {
            let off = turn(&again, limb).angle_between(start * turn(&own, limb)).to_degrees();
            assert!(off < 1.0, "{name} at {k}: {off} degrees");
        }
        let rest = Quat::from_mat3a(&dancer.body.skeleton.world_at_rest[limbs[2]].matrix3);
        moved = moved.max(turn(&own, limbs[2]).angle_between(rest));
    }
    assert!(moved > 0.5, "control: the arm moves by {moved}");
    let Some(data) = common::data_dir() else { return };
    let body = load_character(&data.join("characters/mh_body.glb")).unwrap().body;
    let clip = retarget(&motion, &body).unwrap();
    let m = measure(&body, &clip);
    println!(
        "head up {:.2}, grounded {:.2}, lowest {:.3} m, knees {:.2}",
        m.head_up, m.grounded, m.lowest, m.knees
    );
    // The dance has a deep bow.
    assert!(m.head_up > 0.9 && m.grounded > 0.5 && m.knees > 0.97 && m.start_turn < 1.0);
    assert!((clip.duration_secs - dancer.clips[0].duration_secs).abs() < 0.05);
    // A figure without names is refused with a sentence.
    let fox = load_motion(&data.join("characters/Fox.glb")).unwrap();
    assert!(fox.notes.iter().any(|note| note.contains("clips")), "{:?}", fox.notes);
    let error = retarget(&fox, &body).expect_err("a fox").to_string();
    assert!(error.contains("neither the name nor the place"), "{error}");
}
