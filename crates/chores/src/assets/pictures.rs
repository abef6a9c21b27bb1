//! The images that `cargo xtask assets --preview DIR` writes: body, head, details and the dance as a contact sheet.

use std::path::Path;

use glam::{Vec2, Vec3};
use image::RgbImage;

use super::dance::{LocalPose, world_of};
use super::glb::{Influences, Model, SampledClip};
use super::preview::{Camera, Canvas, View};
use super::rig;

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

/// A figure as one surface, for the preview.
struct Figure<'a> {
    model: &'a Model,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    colours: Vec<Vec3>,
    painted: Vec<Vec3>,
    uv: Vec<Vec2>,
    influences: Vec<Influences>,
    triangles: Vec<([u32; 3], Option<usize>)>,
    textures: Vec<RgbImage>,
}

impl<'a> Figure<'a> {
    fn new(model: &'a Model) -> anyhow::Result<Self> {
        let textures = model.images.iter().map(|image| Ok(image::load_from_memory(&image.bytes)?.to_rgb8()));
        let mut out = Self {
            model,
            positions: Vec::new(),
            normals: Vec::new(),
            colours: Vec::new(),
            painted: Vec::new(),
            uv: Vec::new(),
            influences: Vec::new(),
            triangles: Vec::new(),
            textures: textures.collect::<anyhow::Result<_>>()?,
        };
        for part in &model.parts {
            let material = &model.materials[part.material];
            let first = out.positions.len() as u32;
            let mask = |name: &str, v: usize| {
                part.masks.iter().find(|(n, _)| *n == name).map_or(0.0, |(_, values)| values[v])
            };
            for v in 0..part.positions.len() {
                let colour = material.colour * mask("_OCCLUSION", v);
                out.colours.push(colour);
                let grows = |name: &str, c: Vec3, to: Vec3| c.lerp(to, 0.9 * mask(name, v));
                let hairy = grows("_SCALP", colour, Vec3::new(0.05, 0.03, 0.02));
                let hairy = grows("_BROW", hairy, Vec3::new(0.05, 0.03, 0.02));
                let hairy = grows("_LASH_UPPER", hairy, Vec3::new(0.0, 0.0, 1.0));
                out.painted.push(grows("_LASH_LOWER", hairy, Vec3::new(0.0, 1.0, 0.0)));
            }
            out.positions.extend(&part.positions);
            out.normals.extend(&part.normals);
            out.uv.extend(&part.uv);
            out.influences.extend(&part.influences);
            out.triangles.extend(part.triangles.iter().map(|t| (t.map(|v| v + first), material.image)));
        }
        Ok(out)
    }

    fn view(&self) -> View<'_> {
        View {
            positions: &self.positions,
            normals: &self.normals,
            colours: &self.colours,
            uv: &self.uv,
            triangles: &self.triangles,
            textures: &self.textures,
        }
    }
}

/// Writes all images into `folder`.
pub(super) fn write(model: &Model, folder: &Path) -> anyhow::Result<()> {
    let figure = Figure::new(model)?;
    let view = figure.view();
    let v = Vec3::new;
    let crown = figure.positions.iter().map(|p| p.y).fold(0.0, f32::max);
    let k = crown / 1.70;
    let body = [0.0, 45.0, 90.0, 180.0].map(|angle| around(v(0.0, 0.86 * k, 0.0), angle, 5.0 * k, 0.1, 0.36));
    grid(&view, &body, 4, [500, 1000], &folder.join("body.png"))?;

    let head = v(0.0, crown - 0.12, 0.01);
    let face = [(0.0, 0.0), (35.0, 0.02), (90.0, 0.0), (180.0, 0.0), (140.0, 0.1), (-25.0, -0.12)]
        .map(|(angle, up)| around(head, angle, 1.1, up, 0.25));
    grid(&view, &face, 3, [600, 675], &folder.join("head.png"))?;

    let rest = |joint: usize| model.joints[joint].rest;
    let details = [
        around(v(0.09, crown - 0.34, 0.0), 20.0, 0.9, 0.25, 0.42),
        around(v(0.09, crown - 0.34, 0.0), 120.0, 0.9, 0.15, 0.42),
        around(rest(rig::CLAVICLE + rig::HAND) + v(0.04, -0.07, 0.03), 20.0, 0.6, 0.1, 0.42),
        around(rest(rig::THIGH + rig::FOOT), 50.0, 0.8, 0.25, 0.42),
        around(rest(rig::HIPS), 10.0, 1.2, 0.0, 0.42),
        around(head + v(0.0, 0.0, 0.07), 0.0, 0.5, 0.0, 0.30),
    ];
    grid(&view, &details, 3, [600, 600], &folder.join("detail.png"))?;

    let painted = View { colours: &figure.painted, ..view };
    let scalp = [(20.0, 0.05), (80.0, 0.0), (165.0, 0.1), (0.0, 0.0), (50.0, -0.3), (115.0, 0.0)]
        .map(|(angle, up)| around(head, angle, 1.1, up, 0.25));
    grid(&painted, &scalp, 3, [600, 675], &folder.join("scalp.png"))?;

    // The face with its morph targets at full weight.
    let mut canvas = Canvas::new(600 * 3, 450 * 2);
    for m in 0..model.morphs.len().min(6) {
        let mut moved = figure.positions.clone();
        let mut first = 0;
        // The last one shows the lids half closed.
        let half = m == 5;
        for part in &model.parts {
            let mut add = |target: usize, weight: f32| {
                for (vertex, by) in part.moves.get(target).into_iter().flatten() {
                    moved[first + *vertex as usize] += *by * weight;
                }
            };
            add(m, 1.0);
            if half {
                add(0, 0.5);
            }
            first += part.positions.len();
        }
        let posed = View { positions: &moved, ..view };
        let camera = around(v(0.0, crown - 0.115, 0.07), 15.0, 0.5, 0.0, 0.18);
        canvas.draw(&posed, camera, [m % 3 * 600, m / 3 * 450, 600, 450]);
    }
    canvas.save(&folder.join("morphs.png"))?;

    // Each second of the dance from four sides.
    if let Some(clip) = model.clips.first() {
        let mut canvas = Canvas::new(2000, 4 * 420);
        for (row, angle) in [0.0, 90.0, 180.0, 270.0].into_iter().enumerate() {
            for column in 0..8 {
                let key = 30 + column * (clip.times.len() - 1) / 8;
                let (positions, normals) = skinned(&figure, clip, key);
                let posed = View { positions: &positions, normals: &normals, ..painted };
                let camera = around(clip.hips[key] + v(0.0, 0.10, 0.0), angle, 5.0 * k, 0.3, 0.36);
                canvas.draw(&posed, camera, [column * 250, row * 420, 250, 420]);
            }
        }
        canvas.save(&folder.join("strips.png"))?;
    }
    // Poses in which the skin folds or stretches most.
    let mut canvas = Canvas::new(2000, 1400);
    let folds = [
        (150, 0.0),
        (228, 40.0),
        (310, 60.0),
        (318, -60.0),
        (366, 10.0),
        (366, 170.0),
        (400, 10.0),
        (455, 0.0),
    ];
    for (i, (key, angle)) in folds.into_iter().enumerate() {
        let Some(clip) = model.clips.first() else { break };
        let (positions, normals) = skinned(&figure, clip, key);
        let posed = View { positions: &positions, normals: &normals, ..painted };
        canvas.draw(
            &posed,
            around(clip.hips[key] + v(0.0, 0.22, 0.0), angle, 3.4 * k, 0.3, 0.30),
            [i % 4 * 500, i / 4 * 700, 500, 700],
        );
    }
    canvas.save(&folder.join("folds.png"))?;
    for clip in &model.clips {
        sheet(&figure, &painted, clip, folder)?;
    }
    Ok(())
}

/// The clip as images at equal intervals.
fn sheet(figure: &Figure, view: &View, clip: &SampledClip, folder: &Path) -> anyhow::Result<()> {
    let size = [250, 420];
    let mut canvas = Canvas::new(8 * size[0], SHEET_FRAMES.div_ceil(8) * size[1]);
    for frame in 0..SHEET_FRAMES {
        let (positions, normals) = skinned(figure, clip, frame * (clip.times.len() - 1) / SHEET_FRAMES);
        let posed = View { positions: &positions, normals: &normals, ..*view };
        let camera = around(Vec3::new(0.0, 0.98, 0.0), 8.0, 6.0, 0.35, 0.37);
        canvas.draw(&posed, camera, [frame % 8 * size[0], frame / 8 * size[1], size[0], size[1]]);
    }
    canvas.save(&folder.join(format!("{}.png", clip.name)))
}

/// Positions and normals at one key, by linear blending.
fn skinned(figure: &Figure, clip: &SampledClip, key: usize) -> (Vec<Vec3>, Vec<Vec3>) {
    let joints = &figure.model.joints;
    let pose = LocalPose { rotations: clip.rotations.iter().map(|r| r[key]).collect(), hips: clip.hips[key] };
    let world = world_of(joints, &pose);
    let vertices = figure.positions.iter().zip(&figure.normals).zip(&figure.influences);
    vertices
        .map(|((rest, normal), influences)| {
            let (mut p, mut n) = (Vec3::ZERO, Vec3::ZERO);
            for (joint, weight) in influences {
                let (rotation, place) = world[usize::from(*joint)];
                let weight = f32::from(*weight) / 65535.0;
                p += (rotation * (*rest - joints[usize::from(*joint)].rest) + place) * weight;
                n += (rotation * *normal) * weight;
            }
            (p, n.normalize_or(Vec3::Y))
        })
        .unzip()
}
