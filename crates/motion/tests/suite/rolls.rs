//! Rigs whose bones all lie along +X at zero rotation, and are rolled about themselves.

use crate::common;

use std::path::Path;
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};
use lovelock_motion::{
    Body, Clip, MotionFile, MotionJoint, Pose, load_character, load_motion, pose_at, retarget,
};

fn dancer() -> Option<Arc<Body>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    if !file.is_file() {
        println!("skipped: no assets/dancer.glb");
        return None;
    }
    Some(load_character(&file).expect("the shipped dancer loads").body)
}

fn named(body: &Body, name: &str) -> usize {
    body.skeleton.joints.iter().position(|j| j.name == name).expect("a joint")
}

/// A bone: name, parent, offset, direction in a T-pose, and the roll by the rig.
type Bone = (&'static str, Option<usize>, [f32; 3], Vec3, f32);

/// A figure whose zero pose does not stand. `half` and `quarter` are the rolls of the right arm and of the
/// feet, radians.
fn bones(half: f32, quarter: f32) -> Vec<Bone> {
    let (l, r, down) = (Vec3::X, Vec3::NEG_X, Vec3::NEG_Y);
    vec![
        ("Hips", None, [0.0, 0.9, 0.0], Vec3::X, 0.0),
        ("Spine", Some(0), [0.0, 0.13, 0.0], Vec3::Y, 0.0),
        ("Neck", Some(1), [0.4, 0.0, 0.0], Vec3::Y, 0.0),
        ("Head", Some(2), [0.08, 0.0, 0.0], Vec3::Y, 0.0),
        ("LeftShoulder", Some(1), [0.35, -0.04, 0.0], l, 0.0),
        ("LeftArm", Some(4), [0.13, 0.0, 0.0], l, 0.0),
        ("LeftForeArm", Some(5), [0.26, 0.0, 0.0], l, 0.0),
        ("LeftHand", Some(6), [0.25, 0.0, 0.0], l, 0.0),
        ("RightShoulder", Some(1), [0.35, 0.04, 0.0], r, half),
        ("RightArm", Some(8), [0.13, 0.0, 0.0], r, half),
        ("RightForeArm", Some(9), [0.26, 0.0, 0.0], r, half),
        ("RightHand", Some(10), [0.25, 0.0, 0.0], r, half),
        ("LeftUpLeg", Some(0), [0.1, -0.02, 0.0], down, 0.0),
        ("LeftLeg", Some(12), [0.42, 0.0, 0.0], down, 0.0),
        ("LeftFoot", Some(13), [0.42, 0.0, 0.0], Vec3::Z, quarter),
        ("LeftToeBase", Some(14), [0.15, 0.0, 0.0], Vec3::Z, quarter),
        ("RightUpLeg", Some(0), [-0.1, -0.02, 0.0], down, 0.0),
        ("RightLeg", Some(16), [0.42, 0.0, 0.0], down, 0.0),
        ("RightFoot", Some(17), [0.42, 0.0, 0.0], Vec3::Z, quarter),
        ("RightToeBase", Some(18), [0.15, 0.0, 0.0], Vec3::Z, quarter),
    ]
}

/// A motion of that figure in which it lowers its arms and nods by a radian.
fn motion(half: f32, quarter: f32) -> MotionFile {
    let bones = bones(half, quarter);
    let frames = 20;
    let mut file = MotionFile { name: "rolled".into(), frames, frame_secs: 0.05, ..MotionFile::default() };
    for &(name, parent, offset, ..) in &bones {
        let end = (!bones.iter().any(|b| b.1.is_some_and(|p| bones[p].0 == name))).then_some(Vec3::X * 0.1);
        file.joints.push(MotionJoint { name: name.into(), parent, offset: offset.into(), end });
    }
    // By the smallest rotations from the parent's, and then rolled.
    let mut pose: Vec<Quat> = Vec::new();
    for &(_, parent, _, along, _) in &bones {
        let carried = parent.map_or(Quat::IDENTITY, |p| pose[p]);
        pose.push(Quat::from_rotation_arc(carried * Vec3::X, along) * carried);
    }
    for frame in 0..frames {
        let t = frame as f32 / (frames - 1) as f32;
        let mut world: Vec<Quat> = Vec::new();
        for (j, &(name, parent, offset, _, roll)) in bones.iter().enumerate() {
            let arm = |side: f32| Quat::from_rotation_z(-1.2 * t * side);
            let moved = match name {
                "LeftArm" | "LeftForeArm" | "LeftHand" => arm(1.0),
                "RightArm" | "RightForeArm" | "RightHand" => arm(-1.0),
                "Head" => Quat::from_rotation_x(t),
                _ => Quat::IDENTITY,
            };
            world.push((moved * pose[j] * Quat::from_rotation_x(roll)).normalize());
            let carrier = parent.map_or(Quat::IDENTITY, |p| world[p]);
            file.rotations.push((carrier.conjugate() * world[j]).normalize());
            file.positions.push(offset.into());
        }
    }
    file
}

/// Largest angle between the rotations of a joint in two clips, radians.
fn largest_angle(a: &Clip, b: &Clip, joint: usize) -> f32 {
    let turns = |clip: &Clip| {
        let track = clip.joints.iter().find(|track| track.joint == joint);
        track.and_then(|track| track.rotation.as_ref()).map(|track| track.values.clone()).unwrap_or_default()
    };
    let (a, b) = (turns(a), turns(b));
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).map(|(a, b)| a.angle_between(*b)).fold(0.0, f32::max)
}

#[test]
fn rolled_bones_move_like_others() {
    let Some(body) = dancer() else { return };
    let plain = retarget(&motion(0.0, 0.0), &body).unwrap();
    let joints = 0..body.skeleton.joints.len();
    for (half, quarter) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (1.0, -1.0)] {
        let (half, quarter) = (half * std::f32::consts::PI, quarter * std::f32::consts::FRAC_PI_2);
        let rolled = retarget(&motion(half, quarter), &body).unwrap();
        let most = joints.clone().map(|j| largest_angle(&plain, &rolled, j)).fold(0.0, f32::max);
        assert!(most < 2e-3, "rolled by {half} and {quarter}: off by {most} radians");
    }
    // Control: a roll that is not such a multiple does not come from the rig and stays.
    let turned = retarget(&motion(0.6, 0.0), &body).unwrap();
    let most = joints.map(|j| largest_angle(&plain, &turned, j)).fold(0.0, f32::max);
    assert!((0.5..0.7).contains(&most), "{most} radians");
}

#[test]
fn a_stiff_neck_takes_half_of_the_bend_of_the_head() {
    let Some(body) = dancer() else { return };
    let clip = retarget(&motion(0.0, 0.0), &body).unwrap();
    let neck = body.skeleton.joints[body.head_joint].parent.expect("a neck");
    let bend = |joint: usize| {
        let track = clip.joints.iter().find(|track| track.joint == joint).expect("it turns");
        let turns = &track.rotation.as_ref().expect("it turns").values;
        turns[0].angle_between(turns[turns.len() - 1])
    };
    let (of_neck, of_head) = (bend(neck), bend(body.head_joint));
    assert!((of_neck - 0.5).abs() < 0.01 && (of_head - 0.5).abs() < 0.01, "{of_neck} and {of_head} radians");
}

#[test]
fn a_part_of_a_dance_is_retargeted_like_the_whole() {
    let (Some(data), Some(body)) = (common::data_dir(), dancer()) else { return };
    let whole = load_motion(&data.join("motion/jesse_dance.bvh")).unwrap();
    let all = retarget(&whole, &body).unwrap();
    let limbs = [
        "clavicle_l",
        "clavicle_r",
        "upper_arm_l",
        "upper_arm_r",
        "forearm_l",
        "forearm_r",
        "thigh_l",
        "shin_r",
    ];
    let count = whole.joints.len();
    // In this motion arms roll by up to 101 degrees, by 84 degrees on average in its last second.
    let moments = (0..whole.frames).step_by(10).map(|first| (first, 1)).chain([(whole.frames - 66, 66)]);
    for (first, frames) in moments {
        let mut cut = whole.clone();
        cut.frames = frames;
        cut.rotations = whole.rotations[first * count..(first + frames) * count].to_vec();
        cut.positions = whole.positions[first * count..(first + frames) * count].to_vec();
        let part = retarget(&cut, &body).unwrap();
        for limb in limbs {
            let turns = |clip: &Clip| {
                let joint = named(&body, limb);
                let track = clip.joints.iter().find(|track| track.joint == joint).expect("it turns");
                track.rotation.as_ref().expect("it turns").values.clone()
            };
            let off = turns(&part)[0].angle_between(turns(&all)[first]).to_degrees();
            assert!(off < 0.5, "{limb} in frame {first}, of {frames}: {off} degrees");
        }
    }
}

/// Mean roll of a joint about its bone relative to its parent over a clip, degrees.
fn roll(body: &Body, clip: &Clip, joint: usize) -> f32 {
    let skeleton = &body.skeleton;
    let carrier = skeleton.joints[joint].parent.expect("a carrier");
    let bones = (0..skeleton.joints.len()).filter(|&j| skeleton.joints[j].parent == Some(joint));
    let bones = bones.map(|j| skeleton.rest_position(j) - skeleton.rest_position(joint));
    // Joints that share its roll may be at the same position.
    let bone = bones.max_by(|a, b| a.length().total_cmp(&b.length()));
    let axis = bone.expect("a bone").normalize_or(Vec3::Y);
    let (mut pose, mut sum) = (Pose::default(), Vec2::ZERO);
    for frame in 0..100 {
        pose_at(body, Some(clip), f64::from(frame) / 100.0 * clip.duration_secs, &mut pose);
        let turn = |j: usize| (pose.world_from_joint[j] * skeleton.world_at_rest[j].inverse()).matrix3;
        let against = Quat::from_mat3a(&(turn(carrier).transpose() * turn(joint)));
        sum += Vec2::from_angle(2.0 * against.xyz().dot(axis).atan2(against.w));
    }
    sum.to_angle().to_degrees()
}

#[test]
fn no_shoulder_or_foot_is_twisted() {
    let Some(data) = common::data_dir() else { return };
    let Some(body) = dancer() else { return };
    let named = |name: &str| named(&body, name);
    // In jesse_dance every bone lies along +X at zero rotation, and those of the right arm and of the feet
    // are rolled. Smallest rotations alone left the right shoulder twisted by 180 degrees and the feet by 85
    // and 94.
    for file in ["jesse_dance", "cmu1_jumping_jacks", "fair1_dab", "mh_walk1", "assimp_Boxing_Toes"] {
        let motion = load_motion(&data.join("motion").join(file).with_extension("bvh")).unwrap();
        let clip = retarget(&motion, &body).unwrap();
        let rolls = ["clavicle", "upper_arm", "forearm", "thigh", "shin", "foot"].map(|limb| {
            let [left, right] = ["l", "r"].map(|side| roll(&body, &clip, named(&format!("{limb}_{side}"))));
            // Arms rotate outward and inward by more than 45 degrees.
            let most = if limb == "upper_arm" { 80.0 } else { 45.0 };
            assert!(left.abs().max(right.abs()) < most, "{file}: {limb} {left:.0} and {right:.0} degrees");
            [left, right].map(|angle| angle.round() as i32)
        });
        println!("{file}: {rolls:?} degrees, left and right");
        // Control: a shoulder that is twisted on purpose is detected.
        let mut twisted = clip.clone();
        let shoulder = named("clavicle_r");
        for track in twisted.joints.iter_mut().filter(|track| track.joint == shoulder) {
            let axis = body.skeleton.world_at_rest[shoulder]
                .inverse()
                .transform_vector3(
                    body.skeleton.rest_position(named("upper_arm_r")) - body.skeleton.rest_position(shoulder),
                )
                .normalize_or(Vec3::Y);
            for turn in &mut track.rotation.as_mut().expect("it turns").values {
                *turn *= Quat::from_axis_angle(axis, 3.0);
            }
        }
        assert!(roll(&body, &twisted, shoulder).abs() > 120.0, "{file}");
    }
}

#[test]
fn an_uncaptured_neck_shares_the_bend_of_the_head() {
    let Some(data) = common::data_dir() else { return };
    let Some(body) = dancer() else { return };
    let skeleton = &body.skeleton;
    let neck = skeleton.joints[body.head_joint].parent.expect("a neck");
    let chest = skeleton.joints[neck].parent.expect("a chest");
    let mut pose = Pose::default();
    // Largest bend of the neck and of the head relative to the chest, degrees.
    let mut bends = |file: &str| {
        let motion = load_motion(&data.join("motion").join(file)).unwrap();
        let clip = retarget(&motion, &body).unwrap();
        let mut most = [0.0_f32; 2];
        for frame in 0..100 {
            pose_at(&body, Some(&clip), f64::from(frame) / 100.0 * clip.duration_secs, &mut pose);
            let turn = |j: usize| {
                let turn = pose.world_from_joint[j] * skeleton.world_at_rest[j].inverse();
                Quat::from_mat3a(&turn.matrix3)
            };
            for (most, joint) in most.iter_mut().zip([neck, body.head_joint]) {
                *most = most.max(turn(chest).angle_between(turn(joint)).to_degrees());
            }
        }
        most
    };
    let [neck, head] = bends("jesse_dance.bvh");
    println!("neck {neck:.1}, head {head:.1} degrees");
    assert!(head > 20.0 && (neck - 0.5 * head).abs() < 0.5, "neck {neck} and head {head} degrees");
    // Control: a captured neck has its own bend.
    let [neck, head] = bends("mh_walk1.bvh");
    assert!((neck - 0.5 * head).abs() > 3.0, "neck {neck} and head {head} degrees");
}

#[test]
fn any_motion_of_any_figure_is_retargeted_or_refused() {
    let Some(body) = dancer() else { return };
    // A mixed Weyl sequence, from -1 to 1.
    let mut state = 7_u64;
    let mut next = || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (state ^ (state >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        (mixed >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    };
    let mut carried = 0;
    for round in 0..60 {
        let mut file = motion(next(), next());
        file.frames = [1, 2, 20][round % 3];
        file.rotations.truncate(file.frames * file.joints.len());
        file.positions.truncate(file.frames * file.joints.len());
        for turn in &mut file.rotations {
            if next() > 0.0 {
                *turn = Quat::from_xyzw(next(), next(), next(), next() + 1e-3).normalize();
            }
        }
        for joint in &mut file.joints {
            // Bones of zero length, of metres, and of a tiny length.
            joint.offset *= [1.0, 0.0, 1e6, 1e-30][(4.0 * next().abs()) as usize % 4];
            if next() > 0.9 {
                joint.name = "Lost".into();
            }
        }
        if let Ok(clip) = retarget(&file, &body) {
            carried += 1;
            let rotations = clip.joints.iter().filter_map(|track| track.rotation.as_ref());
            assert!(rotations.flat_map(|track| &track.values).all(|turn| turn.is_finite()), "round {round}");
        }
    }
    println!("{carried} of 60 were retargeted");
    assert!((10..60).contains(&carried), "{carried}");
}
