//! Compares the skinned surface of a character with vertices that another program evaluated.
//!
//! `cargo run -p lovelock-motion --example evaluated -- FILE FOLDER [MOTION]` plays the first clip of the file, or a motion file that is
//! retargeted to it. It reads `FOLDER/times.json`, a list of `[frame, seconds]`, and
//! `FOLDER/verts_FRAME.f32`, three little-endian floats per vertex in metres, Y up. For each time it prints the largest distance of a
//! vertex from the nearest one of the other program, in both directions, in millimetres.

use std::path::Path;
use std::sync::Arc;

use glam::Vec3;
use lovelock_motion::{Pose, Skin, load_character, load_motion, pose_at, retarget, skin};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (file, folder, motion) = match arguments.as_slice() {
        [file, folder] => (file, folder, None),
        [file, folder, motion] => (file, folder, Some(motion)),
        _ => return Err("wanted FILE FOLDER [MOTION]".into()),
    };
    let character = load_character(Path::new(file))?;
    println!("{}", serde_json::to_string_pretty(&character.info())?);
    let body = &character.body;
    let clip = match motion {
        None => character.clips.first().cloned(),
        Some(motion) => {
            let motion = load_motion(Path::new(motion))?;
            println!("{}", serde_json::to_string_pretty(&motion.info())?);
            Some(Arc::new(retarget(&motion, body)?))
        }
    };
    let times: Vec<(u32, f64)> =
        serde_json::from_slice(&std::fs::read(Path::new(folder).join("times.json"))?)?;
    let (mut pose, mut surface) = (Pose::default(), Skin::default());
    for (frame, secs) in times {
        let bytes = std::fs::read(Path::new(folder).join(format!("verts_{frame}.f32")))?;
        let numbers: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        let theirs: Vec<Vec3> = numbers.as_chunks::<3>().0.iter().map(|p| Vec3::from(*p)).collect();
        let end = clip.as_ref().map_or(0.0, |clip| clip.duration_secs.next_down());
        pose_at(body, clip.as_deref(), secs.min(end), &mut pose);
        skin(body, &pose, &mut surface);
        let furthest = |from: &[Vec3], to: &[Vec3]| {
            let of = |p: &Vec3| to.iter().map(|q| q.distance_squared(*p)).fold(f32::MAX, f32::min);
            1000.0 * from.par_iter().map(of).reduce(|| 0.0, f32::max).sqrt()
        };
        let (ours_off, theirs_off) =
            (furthest(&surface.positions, &theirs), furthest(&theirs, &surface.positions));
        println!("frame {frame}, {secs:.3} s: {ours_off:.4} mm and {theirs_off:.4} mm");
    }
    Ok(())
}
