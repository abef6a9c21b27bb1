//! BVH files as programs write them: other units and axes, positions on every joint, other rest poses. One dance, written in
//! each of these ways, must be read as the same dance.

use crate::common;

use std::fmt::Write as _;

use glam::{EulerRot, Quat, Vec3};
use lovelock_motion::{
    Body, LengthUnit, MotionFile, MotionSettings, Pose, Skin, UpAxis, load_character, load_motion,
    load_motion_bytes, pose_at, retarget, skin,
};

/// Name, parent, and offset in a T-pose that faces +Z, metres.
const JOINTS: [(&str, usize, [f32; 3]); 19] = [
    ("Hips", 0, [0.0, 0.95, 0.0]),
    ("Spine", 0, [0.0, 0.12, 0.0]),
    ("Chest", 1, [0.0, 0.15, 0.0]),
    ("Neck", 2, [0.0, 0.24, 0.0]),
    ("Head", 3, [0.0, 0.1, 0.0]),
    ("LeftShoulder", 2, [0.03, 0.2, 0.0]),
    ("LeftArm", 5, [0.14, 0.0, 0.0]),
    ("LeftForeArm", 6, [0.28, 0.0, 0.0]),
    ("LeftHand", 7, [0.25, 0.0, 0.0]),
    ("RightShoulder", 2, [-0.03, 0.2, 0.0]),
    ("RightArm", 9, [-0.14, 0.0, 0.0]),
    ("RightForeArm", 10, [-0.28, 0.0, 0.0]),
    ("RightHand", 11, [-0.25, 0.0, 0.0]),
    ("LeftUpLeg", 0, [0.09, -0.05, 0.0]),
    ("LeftLeg", 13, [0.0, -0.42, 0.0]),
    ("LeftFoot", 14, [0.0, -0.4, 0.0]),
    ("RightUpLeg", 0, [-0.09, -0.05, 0.0]),
    ("RightLeg", 16, [0.0, -0.42, 0.0]),
    ("RightFoot", 17, [0.0, -0.4, 0.0]),
];
const FRAMES: usize = 60;

fn offset(joint: usize) -> Vec3 {
    Vec3::from(JOINTS[joint].2)
}

/// World rotation of a joint relative to the T-pose: arms swing and hang, knees bend, the trunk turns.
fn turn(joint: usize, frame: usize) -> Quat {
    let t = frame as f32 / FRAMES as f32 * std::f32::consts::TAU;
    let trunk = Quat::from_rotation_y(0.4 * t.sin());
    let swing = |sign: f32| 0.5 * (t + sign).sin();
    match JOINTS[joint].0 {
        "LeftArm" | "LeftHand" => trunk * Quat::from_rotation_z(-1.0 + swing(1.0)),
        "LeftForeArm" => trunk * Quat::from_rotation_y(-0.6) * Quat::from_rotation_z(-1.0 + swing(1.0)),
        "RightArm" | "RightHand" => trunk * Quat::from_rotation_z(1.0 + swing(2.0)),
        "RightForeArm" => trunk * Quat::from_rotation_y(0.6) * Quat::from_rotation_z(1.0 + swing(2.0)),
        "LeftUpLeg" => trunk * Quat::from_rotation_x(-0.25 + 0.25 * t.cos()),
        "LeftLeg" => trunk * Quat::from_rotation_x(0.25 - 0.25 * t.cos()),
        "Head" => trunk * Quat::from_rotation_x(0.2 * t.sin()),
        _ => trunk,
    }
}

/// How the dance is written.
#[derive(Clone, Copy)]
struct Writing {
    /// Units per metre.
    scale: f32,
    z_up: bool,
    /// World rotation of each joint's bones from the T-pose to the pose in which all channels are zero.
    zero_pose: fn(usize) -> Quat,
    /// Positions on every joint, and a factor by which their OFFSETs are wrong.
    positions: Option<f32>,
    /// A root on the floor above the hips, which carries the figure.
    floor_root: bool,
}

const PLAIN: Writing =
    Writing { scale: 100.0, z_up: false, zero_pose: |_| Quat::IDENTITY, positions: None, floor_root: false };

fn written(w: Writing) -> String {
    let axes = if w.z_up { Quat::from_rotation_x(std::f32::consts::FRAC_PI_2) } else { Quat::IDENTITY };
    let rest = |joint: usize| {
        let bone = if joint == 0 { offset(0) } else { (w.zero_pose)(JOINTS[joint].1) * offset(joint) };
        axes * bone * w.scale
    };
    let stated = |joint: usize| rest(joint) * w.positions.unwrap_or(1.0);
    let numbers = |v: Vec3| format!("{:.6} {:.6} {:.6}", v.x, v.y, v.z);
    let mut text = "HIERARCHY\n".to_owned();
    if w.floor_root {
        text += "ROOT joint_Root {\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
    }
    let mut order = Vec::new();
    joint_text(0, w, &mut order, &mut |joint, text: &mut String| *text += &numbers(stated(joint)), &mut text);
    text += if w.floor_root { "}\n" } else { "" };
    write!(text, "MOTION\nFrames: {FRAMES}\nFrame Time: 0.033333\n").expect("memory");
    for frame in 0..FRAMES {
        if w.floor_root {
            text += "0 0 0 0 0 0 ";
        }
        // A rotation of the file: from the zero pose, in the axes of the file.
        let world =
            |joint: usize| axes * turn(joint, frame) * (w.zero_pose)(joint).inverse() * axes.inverse();
        for &joint in &order {
            if joint == 0 || w.positions.is_some() {
                text += &numbers(rest(joint));
                text.push(' ');
            }
            let parent = if joint == 0 { Quat::IDENTITY } else { world(JOINTS[joint].1) };
            let (z, x, y) = (parent.inverse() * world(joint)).to_euler(EulerRot::ZXY);
            write!(text, "{:.5} {:.5} {:.5} ", z.to_degrees(), x.to_degrees(), y.to_degrees())
                .expect("memory");
        }
        text.push('\n');
    }
    text
}

fn joint_text(
    joint: usize,
    w: Writing,
    order: &mut Vec<usize>,
    offset: &mut dyn FnMut(usize, &mut String),
    text: &mut String,
) {
    order.push(joint);
    let root = joint == 0 && !w.floor_root;
    let kind = if root { "ROOT" } else { "JOINT" };
    write!(text, "{kind} {}\n{{\n OFFSET ", JOINTS[joint].0).expect("memory");
    offset(joint, text);
    *text += if joint == 0 || w.positions.is_some() {
        "\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    } else {
        "\n CHANNELS 3 Zrotation Xrotation Yrotation\n"
    };
    let children: Vec<usize> = (1..JOINTS.len()).filter(|&child| JOINTS[child].1 == joint).collect();
    if children.is_empty() {
        *text += " End Site { OFFSET 0 0 0 }\n";
    }
    for child in children {
        joint_text(child, w, order, offset, text);
    }
    *text += "}\n";
}

fn load(text: &str) -> MotionFile {
    load_motion_bytes("x.bvh", text.as_bytes(), MotionSettings::default())
        .unwrap_or_else(|error| panic!("{error}"))
}

fn find(motion: &MotionFile, name: &str) -> usize {
    motion.joints.iter().position(|joint| joint.name == name).expect(name)
}

/// Largest distance between joints of the same name over all frames, metres.
fn difference(a: &MotionFile, b: &MotionFile) -> f32 {
    let (mut of_a, mut of_b) = (Vec::new(), Vec::new());
    let mut largest = 0.0_f32;
    for frame in 0..FRAMES {
        a.world(frame, &mut of_a);
        b.world(frame, &mut of_b);
        for (name, ..) in JOINTS {
            let (p, q) = (of_a[find(a, name)].translation, of_b[find(b, name)].translation);
            largest = largest.max((p - q).length());
        }
    }
    largest
}

#[test]
fn units_and_axes_are_judged_from_the_figure() {
    let plain = load(&written(PLAIN));
    assert!((1.6..1.9).contains(&plain.height_metres), "{}", plain.height_metres);
    for (scale, unit) in [
        (1.0, LengthUnit::Metres),
        (10.0, LengthUnit::Decimetres),
        (100.0, LengthUnit::Centimetres),
        (1000.0, LengthUnit::Millimetres),
        (1.0 / 0.0254, LengthUnit::Inches),
        (0.45 / 0.0254, LengthUnit::Cmu),
    ] {
        for z_up in [false, true] {
            let motion = load(&written(Writing { scale, z_up, ..PLAIN }));
            assert_eq!(Some(motion.unit_metres), unit.metres(), "{unit:?} {:?}", motion.notes);
            assert_eq!(motion.up, if z_up { UpAxis::Z } else { UpAxis::Y });
            let off = difference(&motion, &plain);
            assert!(off < 1e-3, "{unit:?}, Z up {z_up}: {off} m");
        }
    }
}

#[test]
fn a_figure_in_no_usual_unit_is_scaled_to_an_adult() {
    let plain = load(&written(PLAIN));
    for scale in [28.0, 3.0, 5000.0] {
        let motion = load(&written(Writing { scale, ..PLAIN }));
        assert!((motion.height_metres - 1.75).abs() < 1e-3, "{scale}: {} m", motion.height_metres);
        assert!(motion.notes.iter().any(|note| note.contains("no usual unit")), "{:?}", motion.notes);
    }
    // The control: a child in centimetres stays a child.
    let child = load(&written(Writing { scale: 65.0, ..PLAIN }));
    assert_eq!(child.unit_metres, 0.01);
    assert!((child.height_metres - 0.65 * plain.height_metres).abs() < 1e-3);
}

#[test]
fn positions_on_every_joint_decide_on_the_size() {
    let plain = load(&written(PLAIN));
    for floor_root in [false, true] {
        // As in the set of Bandai-Namco; then with OFFSETs that are twice as long, in inches, and zero.
        for wrong in [1.0, 2.0, 1.0 / 2.54, 0.0] {
            let motion = load(&written(Writing { positions: Some(wrong), floor_root, ..PLAIN }));
            assert_eq!(motion.unit_metres, 0.01, "{wrong} {:?}", motion.notes);
            assert!(
                (motion.height_metres - plain.height_metres).abs() < 0.01,
                "{wrong}: {}",
                motion.height_metres
            );
            let off = difference(&motion, &plain);
            assert!(off < 1e-3, "{wrong}: {off} m");
            // The resting figure is that of the channels.
            let rest = motion.rest();
            let leg = rest[find(&motion, "LeftUpLeg")].distance(rest[find(&motion, "LeftFoot")]);
            assert!((leg - 0.82).abs() < 1e-3, "{wrong}: {leg} m");
            let noted = motion.notes.iter().any(|note| note.contains("overrule"));
            assert_eq!(noted, wrong != 1.0, "{wrong} {:?}", motion.notes);
        }
    }
}

/// Rotates the bones of both arms about Z, the left one down by `angle`.
fn arms(joint: usize, angle: f32) -> Quat {
    match JOINTS[joint].0 {
        "LeftArm" | "LeftForeArm" | "LeftHand" => Quat::from_rotation_z(-angle),
        "RightArm" | "RightForeArm" | "RightHand" => Quat::from_rotation_z(angle),
        _ => Quat::IDENTITY,
    }
}

fn dancer() -> Option<std::sync::Arc<Body>> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    if !path.is_file() {
        println!("skipped: no assets/dancer.glb");
        return None;
    }
    Some(load_character(&path).expect("the dancer").body)
}

/// Name and rotations of a pose in which all channels are zero.
type Rest = (&'static str, fn(usize) -> Quat);

#[test]
fn any_rest_pose_gives_the_same_dance() {
    let Some(body) = dancer() else { return };
    let at = |name: &str| body.skeleton.joints.iter().position(|joint| joint.name == name).expect(name);
    let bones = [
        ("upper_arm_l", "forearm_l", 6, 7),
        ("forearm_l", "hand_l", 7, 8),
        ("upper_arm_r", "forearm_r", 10, 11),
        ("forearm_r", "hand_r", 11, 12),
        ("thigh_l", "shin_l", 13, 14),
        ("shin_l", "foot_l", 14, 15),
        ("thigh_r", "shin_r", 16, 17),
        ("shin_r", "foot_r", 17, 18),
    ];
    let rests: [Rest; 4] = [
        ("T-pose", |_| Quat::IDENTITY),
        ("A-pose", |joint| arms(joint, 0.8)),
        ("arms down", |joint| arms(joint, 1.5)),
        // Every bone along +X, as exporters write whose zero pose is no pose.
        ("zero pose", |joint| {
            let bone = (1..JOINTS.len()).find(|&child| JOINTS[child].1 == joint).map(offset);
            let upright = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2);
            match JOINTS[joint].0 {
                "Hips" | "Spine" | "Chest" | "Neck" | "Head" => upright,
                _ => bone.map_or(Quat::IDENTITY, |bone| {
                    Quat::from_rotation_arc(bone.normalize_or(Vec3::X), Vec3::X)
                }),
            }
        }),
    ];
    for (label, zero_pose) in rests {
        let motion = load(&written(Writing { zero_pose, ..PLAIN }));
        let clip = retarget(&motion, &body).unwrap_or_else(|error| panic!("{label}: {error}"));
        // The clip starts facing +Z.
        let start = {
            let front = turn(0, 0) * Vec3::Z;
            Quat::from_rotation_y(-front.x.atan2(front.z))
        };
        let mut pose = Pose::default();
        let mut worst = 0.0_f32;
        for frame in 0..FRAMES {
            pose_at(&body, Some(&clip), frame as f64 * motion.frame_secs, &mut pose);
            let place = |name: &str| Vec3::from(pose.world_from_joint[at(name)].translation);
            for (from, to, source, end) in bones {
                let wanted = start * turn(source, frame) * offset(end);
                let angle = (place(to) - place(from)).angle_between(wanted).to_degrees();
                worst = worst.max(angle);
            }
        }
        println!("{label}: limbs off by {worst:.2} degrees at most");
        assert!(worst < 3.0, "{label}: {worst} degrees");
    }
}

#[test]
fn several_roots_are_refused_in_a_sentence() {
    let one = "ROOT a { OFFSET 0 0 0 CHANNELS 3 Zrotation Xrotation Yrotation }\n";
    let two =
        format!("HIERARCHY\n{one}{}MOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0 0 0 0\n", one.replace('a', "b"));
    let error = load_motion_bytes("x.bvh", two.as_bytes(), MotionSettings::default()).expect_err("two roots");
    assert!(error.to_string().contains("line 3: a second root, `b`"), "{error}");
}

#[test]
fn real_figures_are_as_tall_as_people_and_stand_on_the_floor() {
    let Some(data) = common::data_dir() else { return };
    let Some(body) = dancer() else { return };
    // A dance may sit down, so the feet alone are measured.
    let feet: Vec<usize> = ["foot_l", "foot_r"]
        .iter()
        .map(|name| body.skeleton.joints.iter().position(|joint| joint.name == *name).expect(name))
        .collect();
    let soles: Vec<usize> = (0..body.mesh.positions.len())
        .filter(|&v| feet.iter().any(|&foot| body.skeleton.is_below(body.dominant_joint(v), foot)))
        .collect();
    for entry in std::fs::read_dir(data.join("motion")).expect("a folder") {
        let path = entry.expect("an entry").path();
        let motion = load_motion(&path).expect("motion");
        let info = motion.info();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        assert!((1.4..2.1).contains(&info.height_m), "{name}: {} m", info.height_m);
        let clip = retarget(&motion, &body).expect("retargeted");
        let (mut pose, mut surface) = (Pose::default(), Skin::default());
        let steps = (clip.duration_secs * 15.0).max(1.0) as usize;
        let lowest: Vec<f32> = (0..steps)
            .map(|step| {
                pose_at(&body, Some(&clip), step as f64 / 15.0, &mut pose);
                skin(&body, &pose, &mut surface);
                soles.iter().map(|&v| surface.positions[v].y).fold(f32::MAX, f32::min)
            })
            .collect();
        let deepest = lowest.iter().copied().fold(f32::MAX, f32::min);
        // In every second the figure touches the floor.
        let highest =
            lowest.windows(15.min(steps)).map(|second| second.iter().copied().fold(f32::MAX, f32::min));
        let highest = highest.fold(f32::MIN, f32::max);
        println!("{name}: {:.2} m, deepest {deepest:.3}, highest standing {highest:.3}", info.height_m);
        assert!(deepest > -0.03 && highest < 0.03, "{name}: {deepest} to {highest} m");
    }
}
