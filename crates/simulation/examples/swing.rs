//! Simulates a preset, or the hair of a file, on the dancer and draws its guides as a strip of frames, from
//! the front, the side and behind.
//!
//! `swing STYLE OUT.png [--wisps N] [--still] [--from SECS] [--frames N] [--every SECS]
//! [--motion dance|backflip|FILE.bvh] [--set '{"settings": "as JSON"}'] [--ties '[{"kind": "Bun"}]']`

use glam::Vec3;
use image::{Rgb, RgbImage};
use lovelock_groom::HairTie;
use lovelock_motion::{Skin, skin};
use lovelock_simulation::{Simulation, StepReport};

#[path = "../tests/common/mod.rs"]
mod common;
use common::{STEP_SECS, Stage, distance_from_style, frame, settings_of, stretch, worse};

/// Size of one image in pixels, and the extent that it shows in metres.
const CELL: (u32, u32) = (300, 400);
const VIEW_HEIGHT: f32 = 1.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let usage = "swing STYLE OUT.png [--wisps N] [--still] [--from SECS] [--frames N] [--every SECS] [--motion M] [--set JSON] [--ties JSON]";
    let style = args.next().ok_or(usage)?;
    let out = args.next().ok_or(usage)?;
    let (mut still, mut from, mut frames, mut every) = (false, 0.0, 10_u32, 0.2_f64);
    let mut settings = settings_of(&style);
    let (mut ties, mut wisps): (Option<Vec<HairTie>>, _) = (None, None);
    let mut motion = "dance".to_owned();
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or(usage);
        match arg.as_str() {
            "--still" => still = true,
            "--from" => from = value()?.parse()?,
            "--frames" => frames = value()?.parse()?,
            "--every" => every = value()?.parse()?,
            "--motion" => motion = value()?,
            "--wisps" => wisps = Some(value()?.parse()?),
            "--ties" => ties = Some(serde_json::from_str(&value()?)?),
            "--set" => settings = serde_json::from_str(&value()?)?,
            _ => return Err(usage.into()),
        }
    }
    let mut stage = Stage::named(&style, wisps);
    stage.play(&motion)?;
    if let Some(ties) = ties {
        stage.tie(&ties);
    }
    println!(
        "{} guides of {} points, {} colliders, dance of {:.2} s",
        stage.style.guides.count(),
        stage.style.guides.points_per_guide,
        stage.colliders.len(),
        stage.dance.duration_secs
    );
    let mut simulation = stage.simulation((!still).then_some(0.0));
    let mut image = RgbImage::from_pixel(CELL.0 * frames, CELL.1 * 3, Rgb([28, 29, 33]));
    let mut surface = Skin::default();
    let end = from + f64::from(frames - 1) * every;
    let steps = (end / f64::from(STEP_SECS)).round().max(stage.dance.duration_secs * 60.0) as u32;
    let (mut all, mut drawn, mut real_stretch) = (StepReport::default(), 0, 0.0_f32);
    let (mut volume, mut last) = (0.0, (0.0, 1.0));
    for step in 0..=steps {
        let time = f64::from(step) * f64::from(STEP_SECS);
        if step > 0 {
            let input = stage.at((!still).then_some(time));
            let report = simulation.step(&input, &settings, STEP_SECS);
            volume += report.hair_volume / report.hair_volume_at_rest / steps as f32;
            all = worse(all, report);
            last = (report.hair_volume, report.hair_volume_at_rest);
            real_stretch = real_stretch.max(stretch(&simulation));
        }
        if drawn < frames && time >= from + f64::from(drawn) * every - 1e-6 {
            stage.at((!still).then_some(time));
            skin(&stage.body, &stage.pose, &mut surface);
            draw(&mut image, drawn, &stage, &surface, &simulation);
            drawn += 1;
        }
        if still && step % 60 == 0 {
            let away = distance_from_style(&simulation);
            let mean = away.iter().sum::<f32>() / away.len() as f32;
            let most = away.iter().copied().fold(0.0, f32::max);
            println!(
                "{time:4.1} s still: distance from the style as a share of the length: mean {:.3} %, max {:.2} %",
                100.0 * mean,
                100.0 * most
            );
        }
    }
    println!("{all:#?}");
    println!("final hair volume: {:.1} % of the rest volume", 100.0 * last.0 / last.1);
    println!("mean hair volume: {:.1} % of the rest volume", 100.0 * volume);
    println!("stretch from the frames {real_stretch:.2e}");
    image.save(out)?;
    Ok(())
}

/// Draws one instant as a column of three views that follow the head.
fn draw(image: &mut RgbImage, column: u32, stage: &Stage, surface: &Skin, simulation: &Simulation) {
    let guides = frame(simulation).guides;
    let centre = Vec3::from(stage.pose.world_from_head.translation) - Vec3::Y * 0.22;
    for view in 0..3 {
        let (right, toward) = [(Vec3::X, Vec3::Z), (Vec3::NEG_Z, Vec3::X), (Vec3::NEG_X, Vec3::NEG_Z)][view];
        let mut canvas = Canvas {
            image,
            corner: (column * CELL.0, view as u32 * CELL.1),
            depth: vec![f32::MIN; (CELL.0 * CELL.1) as usize],
            axes: [right, toward],
            centre,
        };
        let light = (right * 0.4 + Vec3::Y * 0.6 + toward * 0.5).normalize_or_zero();
        for triangle in &stage.body.mesh.triangles {
            let [a, b, c] = triangle.map(|v| v as usize);
            let corners = [a, b, c].map(|v| surface.positions[v]);
            let size = (corners[1] - corners[0]).length().max((corners[2] - corners[0]).length());
            let n = (size / VIEW_HEIGHT * CELL.1 as f32 * 1.5).clamp(1.0, 60.0) as u32;
            let shade = 0.45 + 0.4 * surface.normals[a].dot(light).max(-0.5);
            for i in 0..=n {
                for j in 0..=n - i {
                    let (u, v) = (i as f32 / n as f32, j as f32 / n as f32);
                    let p = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
                    canvas.dot(p, 0.0, Vec3::new(200.0, 190.0, 185.0) * shade);
                }
            }
        }
        let points = guides.points_per_guide;
        for g in 0..guides.count() {
            let hue = (g / 3) as f32 * 0.618 % 1.0;
            let base = Vec3::new(
                150.0 + 100.0 * hue,
                80.0 + 90.0 * (1.0 - hue),
                40.0 + 90.0 * (hue * 2.0 - 1.0).abs(),
            );
            for i in 1..points {
                let (p, q) = (guides.point(g, i - 1), guides.point(g, i));
                let tangent = (q - p).normalize_or_zero();
                let shine = (1.0 - tangent.dot(light).powi(2)).max(0.0).sqrt();
                for k in 0..12 {
                    canvas.dot(p.lerp(q, k as f32 / 12.0), 0.002, base * (0.35 + 0.65 * shine));
                }
            }
        }
    }
}

/// One image with its depth buffer: orthographic, seen from `toward`.
struct Canvas<'a> {
    image: &'a mut RgbImage,
    corner: (u32, u32),
    depth: Vec<f32>,
    axes: [Vec3; 2],
    centre: Vec3,
}

impl Canvas<'_> {
    fn dot(&mut self, p: Vec3, nearer: f32, color: Vec3) {
        let (d, scale) = (p - self.centre, CELL.1 as f32 / VIEW_HEIGHT);
        let x = CELL.0 as f32 * 0.5 + d.dot(self.axes[0]) * scale;
        let y = CELL.1 as f32 * 0.5 - d.y * scale;
        if x < 0.0 || y < 0.0 || x >= CELL.0 as f32 || y >= CELL.1 as f32 {
            return;
        }
        let (x, y) = (x as u32, y as u32);
        let depth = &mut self.depth[(y * CELL.0 + x) as usize];
        if *depth < d.dot(self.axes[1]) + nearer {
            *depth = d.dot(self.axes[1]) + nearer;
            let color = color.to_array().map(|v| v.clamp(0.0, 255.0) as u8);
            self.image.put_pixel(self.corner.0 + x, self.corner.1 + y, Rgb(color));
        }
    }
}
