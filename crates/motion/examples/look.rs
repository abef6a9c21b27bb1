//! Draws frames of a motion on a body: skinned vertices from the front and the side, with bones and
//! colliders. `look BODY MOTION|-|CLIP COLUMNS OUT.png`.

use std::path::Path;

use glam::Vec3;
use image::{Rgb, RgbImage};
use lovelock_motion::{
    Clip, ColliderShape, Pose, Skin, fit_colliders, load_character, load_motion, place_colliders, pose_at,
    retarget, skin,
};

const CELL: u32 = 300;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [body, motion, columns, out] = args.as_slice() else {
        return Err("look BODY MOTION|-|CLIP COLUMNS OUT.png".into());
    };
    let character = load_character(Path::new(body))?;
    let columns: u32 = columns.parse()?;
    let clip: Option<Clip> = if motion == "-" {
        None
    } else if let Some(clip) = character.clips.iter().find(|c| c.name == *motion) {
        Some((**clip).clone())
    } else {
        let file = load_motion(Path::new(motion))?;
        println!("{:#?}", file.info());
        Some(retarget(&file, &character.body)?)
    };
    println!("{:#?}", character.info());
    if let Some(clip) = &clip {
        println!(
            "{} {:.2} s, loops {}, seam {:?}",
            clip.name,
            clip.duration_secs,
            clip.loops,
            clip.seam(&character.body)
        );
    }
    let colliders = fit_colliders(&character.body);
    let mut image = RgbImage::from_pixel(CELL * columns, CELL * 2, Rgb([24, 24, 28]));
    let (mut pose, mut surface, mut placed) = (Pose::default(), Skin::default(), Vec::new());
    let scale = CELL as f32 / (character.body.height() * 1.25);
    for column in 0..columns {
        let duration = clip.as_ref().map_or(0.0, |c| c.duration_secs);
        pose_at(&character.body, clip.as_ref(), duration * f64::from(column) / f64::from(columns), &mut pose);
        skin(&character.body, &pose, &mut surface);
        place_colliders(&colliders, &character.body, &pose, &mut placed);
        let centre = Vec3::from(pose.world_from_joint[character.body.head_joint].translation);
        for row in 0..2 {
            let project = |p: Vec3| {
                let d = p - centre;
                let across = if row == 0 { d.x } else { -d.z };
                (
                    (column * CELL) as f32 + CELL as f32 * 0.5 + across * scale,
                    (row * CELL) as f32 + CELL as f32 * 0.95 - p.y * scale,
                )
            };
            let mut dot = |p: Vec3, color: [u8; 3]| {
                let (x, y) = project(p);
                if x >= (column * CELL) as f32
                    && x < ((column + 1) * CELL) as f32
                    && y >= 0.0
                    && y < (CELL * 2) as f32
                {
                    image.put_pixel(x as u32, y as u32, Rgb(color));
                }
            };
            for k in 0..CELL {
                dot(
                    centre * Vec3::new(1.0, 0.0, 1.0)
                        + Vec3::new(1.0, 0.0, 1.0) * (k as f32 / CELL as f32 - 0.5),
                    [60, 60, 60],
                );
            }
            for (p, n) in surface.positions.iter().zip(&surface.normals) {
                let shade = (110.0 + 100.0 * n.dot(Vec3::new(0.4, 0.6, 0.7))).clamp(20.0, 230.0) as u8;
                if (if row == 0 { n.z } else { n.x }) > -0.2 {
                    dot(*p, [shade, shade, shade]);
                }
            }
            for (j, joint) in character.body.skeleton.joints.iter().enumerate() {
                if let Some(parent) = joint.parent {
                    let (a, b) =
                        (pose.world_from_joint[parent].translation, pose.world_from_joint[j].translation);
                    for k in 0..80 {
                        dot(a.lerp(b, k as f32 / 80.0).into(), [230, 120, 40]);
                    }
                }
            }
            for collider in &placed {
                for k in 0..400 {
                    let golden = k as f32 * 2.399_963;
                    let z = 1.0 - 2.0 * (k as f32 + 0.5) / 400.0;
                    let unit = Vec3::new(
                        (1.0 - z * z).sqrt() * golden.cos(),
                        (1.0 - z * z).sqrt() * golden.sin(),
                        z,
                    );
                    let p = match collider.shape {
                        ColliderShape::Ellipsoid { from_unit } => from_unit.transform_point3(unit),
                        ColliderShape::Capsule { a, b, radius_a, radius_b } => {
                            let t = (k % 7) as f32 / 6.0;
                            a.lerp(b, t) + unit * (radius_a + (radius_b - radius_a) * t)
                        }
                    };
                    dot(p, [60, 160, 230]);
                }
            }
        }
    }
    image.save(out)?;
    Ok(())
}
