//! The location of the real files, and files that tests write.

pub mod dance;
pub mod fbx;
pub mod textured;

use std::path::PathBuf;

use glam::Vec3;
use lovelock_gltf::glb;
use lovelock_motion::{
    Character, MotionSettings, Pose, Skin, load_character_bytes, load_motion_bytes, pose_at, skin,
};

/// The folder of real test files. If it is missing, prints a line and returns `None`.
pub fn data_dir() -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let folder = std::env::var_os("LOVELOCK_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    if folder.is_dir() {
        Some(folder)
    } else {
        println!("skipped: no data folder");
        None
    }
}

/// A binary glTF of a document and its buffer.
pub fn glb(document: String, mut buffer: Vec<u8>) -> Vec<u8> {
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let mut file = glb::head(document.into_bytes(), buffer.len() as u64).expect("a short file");
    file.extend(buffer);
    file
}

/// The points of a character in its first clip.
pub fn points_at(character: &Character, secs: f64) -> Vec<Vec3> {
    let (mut pose, mut surface) = (Pose::default(), Skin::default());
    pose_at(&character.body, character.clips.first().map(AsRef::as_ref), secs, &mut pose);
    skin(&character.body, &pose, &mut surface);
    surface.positions
}

#[track_caller]
pub fn assert_near(found: &[Vec3], expected: [Vec3; 3]) {
    let off = expected.map(|p| found.iter().map(|q| q.distance(p)).fold(f32::MAX, f32::min));
    assert!(off.iter().all(|d| *d < 1e-5), "{found:?}, expected {expected:?}");
}

/// Reads bytes as a character and checks what one guarantees. Returns whether they were accepted.
pub fn reads_character(name: &str, bytes: &[u8]) -> bool {
    let character = match load_character_bytes(name, bytes, None) {
        Ok(character) => character,
        Err(error) => {
            assert!(!error.to_string().contains('\n'), "{error}");
            return false;
        }
    };
    assert!(character.body.mesh.positions.iter().all(|p| p.is_finite()));
    assert!(points_at(&character, 0.3).iter().all(|p| !p.is_nan()));
    let joints = character.body.skeleton.joints.len();
    assert!(character.body.mesh.joints.iter().flatten().all(|&joint| usize::from(joint) < joints));
    assert!(lovelock_motion::fit_colliders(&character.body).len() < 100);
    true
}

/// Reads bytes as a motion and checks what one guarantees. Returns whether they were accepted.
pub fn reads_motion(name: &str, bytes: &[u8], settings: MotionSettings) -> bool {
    let motion = match load_motion_bytes(name, bytes, settings) {
        Ok(motion) => motion,
        Err(error) => {
            assert!(!error.to_string().contains('\n'), "{error}");
            return false;
        }
    };
    let count = motion.joints.len() * motion.frames;
    assert!(motion.rotations.len() == count && motion.positions.len() == count);
    assert!(motion.rotations.iter().all(|q| q.is_finite()) && motion.info().height_m.is_finite());
    true
}
