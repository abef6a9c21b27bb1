//! BVH files: analytic cases, special cases, and real files.

use crate::common;

use glam::{Affine3A, Vec3};
use lovelock_motion::{
    LengthUnit, MotionFile, MotionSettings, RootPosition, UpAxis, load_motion, load_motion_bytes,
};

/// One joint, a metre along X from its root, with the given channels and rows.
fn arm(channels: &str, rows: &str) -> String {
    format!(
        "HIERARCHY\nROOT root of all\n{{\n OFFSET 0 0 0\n CHANNELS {channels}\n JOINT arm {{ OFFSET 1 0 0 \
         CHANNELS 0\n End Site {{ OFFSET 1 0 0 }} }} }}\nMOTION\nFrames: 1\nFrame Time: 0.1\n{rows}\n"
    )
}

fn plain() -> MotionSettings {
    MotionSettings { unit: LengthUnit::Metres, up: UpAxis::Y, root: RootPosition::Absolute }
}

fn load(text: &str) -> MotionFile {
    load_motion_bytes("x.bvh", text.as_bytes(), plain()).unwrap_or_else(|e| panic!("{e}"))
}

fn place(motion: &MotionFile, frame: usize, joint: usize) -> Vec3 {
    let mut world: Vec<Affine3A> = Vec::new();
    motion.world(frame, &mut world);
    world[joint].translation.into()
}

#[test]
fn rotations_multiply_in_listed_order() {
    // Rz(90) Ry(90) x = Rz(90) (-z) = -z; Ry(90) Rz(90) x = Ry(90) y = y.
    let zy = load(&arm("3 Zrotation Yrotation Xrotation", "90 90 0"));
    assert!(place(&zy, 0, 1).distance(Vec3::NEG_Z) < 1e-6);
    let yz = load(&arm("3 Yrotation Zrotation Xrotation", "90 90 0"));
    assert!(place(&yz, 0, 1).distance(Vec3::Y) < 1e-6);
    // Rx(90) y = z, after Rz: Rz(90) x = y, then Rx(90) y = z.
    let xz = load(&arm("3 Xrotation Zrotation Yrotation", "90 90 0"));
    assert!(place(&xz, 0, 1).distance(Vec3::Z) < 1e-6);
}

#[test]
fn tolerant_of_what_people_write() {
    let motion = load(
        &arm("3 zrotation YROTATION Xrotation", "\t\t0 0 0 \r\n\r\n10 nan 0\n0 0 360\n1 2")
            .replace('\n', "\r\n"),
    );
    assert_eq!(motion.joints[0].name, "root of all");
    assert_eq!(motion.frames, 3);
    assert_eq!((motion.dropped["numbers"], motion.dropped["rows"]), (1, 1));
    assert!(motion.notes.iter().any(|n| n.contains("promises 1 frames; the 3")), "{:?}", motion.notes);
    // A full turn between two frames is no rotation.
    assert!(motion.rotations[2 * 2].dot(motion.rotations[0]) > 0.999_999);
    // Rows split over lines.
    let split = arm("3 Zrotation Yrotation Xrotation", "0\n0 0\n\n0 0\n0").replace("Frames: 1", "Frames: 2");
    assert_eq!(load(&split).frames, 2);
    // No frame time.
    let timeless = load(&arm("3 Zrotation Yrotation Xrotation", "0 0 0").replace("0.1", "-1"));
    assert!((timeless.frame_secs - 1.0 / 30.0).abs() < 1e-9);
    assert!(timeless.notes.iter().any(|note| note.contains("`-1`")), "{:?}", timeless.notes);
}

#[test]
fn decimal_commas_are_read_in_the_head_too() {
    let text = arm("3 Zrotation Yrotation Xrotation", "90 0 0").replace("OFFSET 1 0 0", "OFFSET 0,5 0 -0,25");
    // In a line with other words and in one of its own.
    for text in [text.clone(), text.replace("-0,25", "-0,25\n")] {
        let motion = load(&text.replace("Frame Time: 0.1", "Frame Time: 0,05"));
        assert_eq!(motion.frame_secs, 0.05);
        assert_eq!(motion.joints[1].offset, Vec3::new(0.5, 0.0, -0.25));
        assert!(motion.notes.iter().all(|note| !note.contains("frame time")), "{:?}", motion.notes);
    }
    // Commas between numbers are none.
    for between in ["OFFSET 0.5,0,-0.25\n", "OFFSET 0.5, 0, -0.25\n"] {
        let motion = load(&text.replace("OFFSET 0,5 0 -0,25", between));
        assert_eq!(motion.joints[1].offset, Vec3::new(0.5, 0.0, -0.25));
    }
    let error =
        load_motion_bytes("x.bvh", text.replace("0,5", "0,5,5").as_bytes(), plain()).expect_err("no number");
    assert!(error.to_string().contains("line 6: found `0,5,5`"), "{error}");
}

#[test]
fn returns_alone_end_lines() {
    let text =
        arm("3 Zrotation Yrotation Xrotation", "90 0 0\n0 -nan(ind) 0").replace("Frames: 1", "Frames: 2");
    for end in ["\n", "\r\n", "\r"] {
        let motion = load(&text.replace('\n', end));
        assert_eq!((motion.frames, motion.dropped["numbers"]), (2, 1));
        assert!(place(&motion, 0, 1).distance(Vec3::Y) < 1e-6);
    }
}

#[test]
fn a_motion_of_days_is_refused() {
    let text = |secs: &str| {
        let rows = ["0 0 0"; 3].join("\n");
        arm("3 Zrotation Yrotation Xrotation", &rows)
            .replace("Frame Time: 0.1", &format!("Frame Time: {secs}"))
    };
    let error = load_motion_bytes("x.bvh", text("3601").as_bytes(), plain()).expect_err("two hours");
    assert!(
        error.to_string().contains("line 10: a frame time of 3601 s makes 3 frames last 7202 s"),
        "{error}"
    );
    assert_eq!(load(&text("3600")).frame_secs, 3600.0);
}

#[test]
fn positions_replace_or_add() {
    let text = |root: &str, limb: &str| {
        format!(
            "HIERARCHY ROOT a\n{{ OFFSET 0 90 0 CHANNELS 3 Xposition Yposition Zposition JOINT LeftUpLeg\n{{ OFFSET 10 0 0 \
             CHANNELS 3 Xposition Yposition Zposition JOINT LeftFoot\n{{ OFFSET 0 -88 0 CHANNELS 0 }} }} JOINT Head\n{{ OFFSET \
             0 60 0 CHANNELS 0 }} }}\nMOTION\nFrames: 1\nFrame Time: 0.1\n{root} {limb}\n"
        )
    };
    let auto = |root: &str, limb: &str| {
        load_motion_bytes("x.bvh", text(root, limb).as_bytes(), MotionSettings::default()).unwrap()
    };
    for (root, limb) in [("0 89 0", "10 0 0"), ("0 -1 0", "0 0 0"), ("0 89 0", "0 0 0"), ("0 -1 0", "10 0 0")]
    {
        let motion = auto(root, limb);
        assert_eq!(motion.unit_metres, 0.01, "{:?}", motion.notes);
        assert!(place(&motion, 0, 0).distance(Vec3::Y * 0.89) < 1e-5, "{root}: {:?}", motion.notes);
        assert!(place(&motion, 0, 2).distance(Vec3::new(0.1, 0.01, 0.0)) < 1e-5, "{limb}");
    }
    // The setting overrides the guess.
    let settings = MotionSettings { root: RootPosition::Added, ..MotionSettings::default() };
    let floating = load_motion_bytes("x.bvh", text("0 89 0", "10 0 0").as_bytes(), settings).unwrap();
    assert!((place(&floating, 0, 0).y - 1.79).abs() < 1e-5);
}

#[test]
fn refusals_name_the_line() {
    for (text, words) in [
        ("", "HIERARCHY"),
        ("HIERARCHY\nROOT a\n{\n OFFSET 0 0 x\n", "line 4"),
        ("HIERARCHY\nROOT a\n{\n OFFSET 0 0 0\n CHANNELS 99\n", "line 5"),
        ("HIERARCHY\nROOT a\n{\n CHANNELS 1 Wrotation\n", "Wrotation"),
        ("HIERARCHY\nJOINT a\n{", "outside a joint"),
        ("HIERARCHY\nROOT a\n{\n OFFSET 0 0 0\nMOTION\n", "still open"),
        (
            "HIERARCHY\nROOT a\n{ OFFSET 0 0 0 CHANNELS 1 Xrotation }\nMOTION\nFrames: 0\nFrame Time: 1\n",
            "no complete frame",
        ),
        ("HIERARCHY\nROOT a\n{ OFFSET 0 0 0 }\n}\n", "brace too many"),
    ] {
        let error = load_motion_bytes("x.bvh", text.as_bytes(), plain()).expect_err(text).to_string();
        assert!(error.starts_with("x.bvh: ") && error.contains(words), "{error}");
    }
    let deep = format!("HIERARCHY\nROOT a\n{{ OFFSET 0 0 0\n{}", "JOINT b\n{ OFFSET 0 1 0\n".repeat(5000));
    assert!(load_motion_bytes("x.bvh", deep.as_bytes(), plain()).unwrap_err().to_string().contains("levels"));
}

#[test]
fn real_files() {
    let Some(data) = common::data_dir() else { return };
    for (file, joints, frames, frame_secs, unit, up) in [
        ("assimp_Boxing_Toes", 21, 3070, 0.01, 0.01, UpAxis::Y),
        ("cmu1_jumping_jacks", 31, 125, 0.03333, 0.0254 / 0.45, UpAxis::Y),
        // In no unit: scaled until it is as tall as an adult.
        ("fair1_dab", 27, 339, 0.033_333_3, 0.0354, UpAxis::Z),
        ("jesse_dance", 60, 1007, 0.01, 0.01, UpAxis::Y),
        ("mh_tpose", 173, 1, 0.041_667, 0.1, UpAxis::Z),
        ("mh_walk1", 75, 14, 0.041_667, 0.1, UpAxis::Z),
    ] {
        let motion = load_motion(&data.join("motion").join(file).with_extension("bvh")).unwrap();
        let info = motion.info();
        assert_eq!((info.joints, info.frames, info.frame_secs), (joints, frames, frame_secs), "{file}");
        assert!((info.unit_metres - unit).abs() < 1e-4 && motion.up == up, "{file} {:?}", info.notes);
        assert!(info.dropped.is_empty(), "{file}");
        // After conversion the root is about a leg's length above the lowest joint.
        let mut world = Vec::new();
        motion.world(0, &mut world);
        let low = world.iter().map(|w| w.translation.y).fold(f32::MAX, f32::min);
        let leg = world[0].translation.y - low;
        assert!((0.4..1.2).contains(&leg), "{file} {leg}");
    }
}
