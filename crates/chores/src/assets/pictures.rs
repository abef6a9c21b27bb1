//! The images that `cargo xtask assets --preview DIR` writes: body, head, details and the dance as a contact sheet.

use std::path::Path;

use glam::Vec3;

use super::dance::{LocalPose, world_of};
use super::glb::{Model, SampledClip};
use super::preview::{Camera, Canvas, View};

/// Images on one contact sheet, in rows of eight.
const SHEET_FRAMES: usize = 24;

/// A camera that looks at `centre` from `distance` metres at an angle from the front, `up` metres above it.
fn around(centre: Vec3, degrees: f32, distance: f32, up: f32, view_angle: f32) -> Camera {
    let (s, c) = degrees.to_radians().sin_cos();
    (centre + Vec3::new(s * distance, up, c * distance), centre, view_angle)
}

/// Several views of one pose in a row or a grid of `columns`, each `size` pixels.
fn grid(
    view: &View,
    cameras: &[Camera],
    columns: usize,
    size: [usize; 2],
    path: &Path,
) -> anyhow::Result<()> {
    let rows = cameras.len().div_ceil(columns);
    let mut canvas = Canvas::new(size[0] * columns, size[1] * rows);
    for (i, camera) in cameras.iter().enumerate() {
        canvas.draw(view, *camera, [i % columns * size[0], i / columns * size[1], size[0], size[1]]);
    }
    canvas.save(path)
}

/// Writes all images into `folder`.
pub(super) fn write(dancer: &Model, folder: &Path) -> anyhow::Result<()> {
    let view = View {
        positions: &dancer.positions,
        normals: &dancer.normals,
        colours: &dancer.colours,
        triangles: &dancer.triangles,
    };
    let v = Vec3::new;
    let body = [0.0, 45.0, 90.0, 180.0].map(|angle| around(v(0.0, 0.86, 0.0), angle, 5.0, 0.1, 0.36));
    grid(&view, &body, 4, [500, 1000], &folder.join("body.png"))?;

    let head = v(0.0, 1.58, 0.01);
    let face = [(0.0, 0.0), (35.0, 0.02), (90.0, 0.0), (180.0, 0.0), (140.0, 0.1), (-25.0, -0.12)]
        .map(|(angle, up)| around(head, angle, 1.1, up, 0.25));
    grid(&view, &face, 3, [600, 675], &folder.join("head.png"))?;

    let details = [
        around(v(0.09, 1.36, 0.0), 20.0, 0.9, 0.25, 0.42),
        around(v(0.09, 1.36, 0.0), 100.0, 0.9, 0.15, 0.42),
        around(v(0.60, 0.97, 0.02), 20.0, 0.6, 0.1, 0.42),
        around(v(0.08, 0.06, 0.03), 50.0, 0.8, 0.25, 0.42),
        around(v(0.0, 0.86, 0.0), 10.0, 1.2, 0.0, 0.42),
        around(v(0.0, 1.58, 0.08), 0.0, 0.5, 0.0, 0.30),
    ];
    grid(&view, &details, 3, [600, 600], &folder.join("detail.png"))?;

    let root = v(0.05, 0.03, 0.02);
    let painted: Vec<Vec3> =
        dancer.colours.iter().zip(&dancer.scalp).map(|(c, s)| c.lerp(root, 0.9 * s)).collect();
    let painted = View { colours: &painted, ..view };
    let scalp =
        [(20.0, 0.05), (80.0, 0.0), (165.0, 0.1)].map(|(angle, up)| around(head, angle, 1.1, up, 0.25));
    grid(&painted, &scalp, 3, [600, 675], &folder.join("scalp.png"))?;

    // Poses in which the skin folds or stretches most.
    let mut canvas = Canvas::new(2000, 1400);
    for (i, (key, angle)) in [
        (150, 0.0),
        (228, 40.0),
        (310, 60.0),
        (318, -60.0),
        (366, 10.0),
        (366, 170.0),
        (400, 10.0),
        (455, 0.0),
    ]
    .into_iter()
    .enumerate()
    {
        let (positions, normals) = skinned(dancer, &dancer.clips[0], key);
        let posed = View { positions: &positions, normals: &normals, ..painted };
        let centre = dancer.clips[0].hips[key] + v(0.0, 0.12, 0.0);
        canvas.draw(&posed, around(centre, angle, 4.6, 0.3, 0.30), [i % 4 * 500, i / 4 * 700, 500, 700]);
    }
    canvas.save(&folder.join("folds.png"))?;
    for clip in &dancer.clips {
        sheet(dancer, &painted, clip, folder)?;
    }
    Ok(())
}

/// The clip as images at equal intervals.
fn sheet(dancer: &Model, view: &View, clip: &SampledClip, folder: &Path) -> anyhow::Result<()> {
    let size = [250, 420];
    let mut canvas = Canvas::new(8 * size[0], SHEET_FRAMES.div_ceil(8) * size[1]);
    for frame in 0..SHEET_FRAMES {
        let (positions, normals) = skinned(dancer, clip, frame * (clip.times.len() - 1) / SHEET_FRAMES);
        let posed = View { positions: &positions, normals: &normals, ..*view };
        let camera = around(Vec3::new(0.0, 0.98, 0.0), 8.0, 6.0, 0.35, 0.37);
        canvas.draw(&posed, camera, [frame % 8 * size[0], frame / 8 * size[1], size[0], size[1]]);
    }
    canvas.save(&folder.join(format!("{}.png", clip.name)))
}

/// Positions and normals at one key, by linear blending.
fn skinned(dancer: &Model, clip: &SampledClip, key: usize) -> (Vec<Vec3>, Vec<Vec3>) {
    let pose = LocalPose { rotations: clip.rotations.iter().map(|r| r[key]).collect(), hips: clip.hips[key] };
    let world = world_of(&dancer.joints, &pose);
    let vertices = dancer.positions.iter().zip(&dancer.normals).zip(&dancer.influences);
    vertices
        .map(|((rest, normal), influences)| {
            let (mut p, mut n) = (Vec3::ZERO, Vec3::ZERO);
            for (joint, weight) in influences {
                let (rotation, place) = world[usize::from(*joint)];
                let weight = f32::from(*weight) / 65535.0;
                p += (rotation * (*rest - dancer.joints[usize::from(*joint)].rest) + place) * weight;
                n += (rotation * *normal) * weight;
            }
            (p, n.normalize_or(Vec3::Y))
        })
        .unzip()
}
