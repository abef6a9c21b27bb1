//! Draws a hairstyle at rest from six sides, to judge a groom without the application.
//!
//! `cargo run --release -p lovelock-groom --example preview -- smooth out.png [length=0.4 curl_radius=0.01 …]`
//! `cargo run --release -p lovelock-groom --example preview -- some.hair out.png [wisps=200 …]`
//!
//! Opaque lines with a depth buffer, shaded after Kajiya and Kay 1989, with self-shadow from a coarse voxel grid.

use std::error::Error;

use glam::{Affine3A, Vec3};
use lovelock_groom::{
    GroomSettings, GuideFrame, Hairstyle, ImportSettings, Obstacle, PlainHead, Preset, Scalp, ScalpIndex,
    Strands, grow, hair_info, import_around, interpolate, load_hair, place,
};
use rayon::prelude::*;
use serde::{Serialize, de::DeserializeOwned};

/// Size of one view, pixels.
const VIEW: [usize; 2] = [460, 600];
/// Samples along each side of a pixel.
const FINE: usize = 3;
/// Height of the image's lower edge, and the size of a pixel, metres.
const BOTTOM: f32 = -0.38;
const PIXEL: f32 = 0.68 / VIEW[1] as f32;
/// Cells of the shadow's grid along each side, and their size in metres.
const GRID: usize = 150;
const CELL: f32 = 0.006;
/// Fraction of the hair's true extinction, as in the default of the voxel map.
const EXTINCTION: f32 = 0.15;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let usage = "usage: preview smooth|curly|long|FILE.hair|FILE.tfx OUT.png [SETTING=VALUE ...]";
    let what = words.next().ok_or(usage)?;
    let path = words.next().ok_or(usage)?;
    let changes: Vec<String> = words.collect();
    let scalp = PlainHead.scalp(48);
    let style = if let Some(preset) = Preset::from_id(&what) {
        grow(&changed(GroomSettings::preset(preset), &changes)?, &scalp, &PlainHead)?
    } else {
        let settings: ImportSettings = changed(ImportSettings::default(), &changes)?;
        let file = load_hair(std::path::Path::new(&what))?;
        println!("{}", serde_json::to_string_pretty(&hair_info(&file, &settings))?);
        let placed = place(&file, &settings, &scalp, Some(&PlainHead))?;
        println!("scale {:.3}, roots moved by {:.4} m", placed.fitted_scale, placed.mean_root_gap_m);
        import_around(&file, &settings, &scalp, Some(&PlainHead))?
    };
    let wisps = style.wisps.len();
    println!("{} strands, {} segments, {wisps} wisps", style.strands.count(), style.strands.segments());
    draw(&style, &scalp, &PlainHead, &path)
}

/// `settings` with the fields named by `changes` set to the given JSON values.
fn changed<T: Serialize + DeserializeOwned>(settings: T, changes: &[String]) -> Result<T, Box<dyn Error>> {
    let mut fields = serde_json::to_value(settings)?;
    for change in changes {
        let (name, value) = change.split_once('=').ok_or("a setting is NAME=VALUE")?;
        let slot = fields.get_mut(name).ok_or_else(|| format!("no setting is called {name}"))?;
        *slot = serde_json::from_str(value)?;
    }
    Ok(serde_json::from_value(fields)?)
}

/// Draws `style` over `body` and writes the image.
fn draw(style: &Hairstyle, scalp: &Scalp, body: &dyn Obstacle, path: &str) -> Result<(), Box<dyn Error>> {
    let mut strands = Strands::default();
    interpolate(style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
    // Camera positions: front, three-quarter, side; back, three-quarter back, top.
    let views = [
        (Vec3::Z, Vec3::Y),
        (Vec3::new(0.75, 0.12, 0.65), Vec3::Y),
        (Vec3::X, Vec3::Y),
        (Vec3::new(-0.1, 0.1, -1.0), Vec3::Y),
        (Vec3::new(-0.8, 0.3, -0.6), Vec3::Y),
        (Vec3::new(0.0, 1.0, 0.25), Vec3::Z),
    ];
    let pictures: Vec<_> = views
        .par_iter()
        .map(|&(from, up)| View::new(from, up).picture(style, &strands, scalp, body))
        .collect();
    let (columns, rows) = (views.len() / 2, 2);
    let (width, height) = (VIEW[0] * columns, VIEW[1] * rows);
    let mut bytes = vec![0; width * height * 3];
    for (v, picture) in pictures.iter().enumerate() {
        for (i, color) in picture.iter().enumerate() {
            let (x, y) = (v % columns * VIEW[0] + i % VIEW[0], v / columns * VIEW[1] + i / VIEW[0]);
            let at = (y * width + x) * 3;
            bytes[at..at + 3].copy_from_slice(&to_srgb(*color));
        }
    }
    image::save_buffer(path, &bytes, width as u32, height as u32, image::ColorType::Rgb8)?;
    Ok(())
}

/// A parallel projection of head space.
struct View {
    right: Vec3,
    up: Vec3,
    /// Toward the camera.
    back: Vec3,
    centre: Vec3,
    light: Vec3,
}

impl View {
    fn new(from: Vec3, up: Vec3) -> Self {
        let back = from.normalize_or(Vec3::Z);
        let right = up.cross(back).normalize_or(Vec3::X);
        let up = back.cross(right);
        // From above the camera's shoulder.
        let light = (0.8 * back + 0.45 * right + 0.9 * up).normalize_or(up);
        let middle = BOTTOM + 0.5 * VIEW[1] as f32 * PIXEL;
        let centre = if up.y > 0.7 { Vec3::Y * middle } else { Vec3::Y * 0.1 };
        Self { right, up, back, centre, light }
    }

    /// Position in subpixels, and depth toward the camera in metres.
    fn project(&self, p: Vec3) -> Vec3 {
        let (q, fine) = (p - self.centre, FINE as f32 / PIXEL);
        let middle = Vec3::new((VIEW[0] * FINE) as f32, (VIEW[1] * FINE) as f32, 0.0) * 0.5;
        middle + Vec3::new(q.dot(self.right) * fine, -q.dot(self.up) * fine, q.dot(self.back))
    }

    fn picture(&self, style: &Hairstyle, strands: &Strands, scalp: &Scalp, body: &dyn Obstacle) -> Vec<Vec3> {
        let shadow = Shadow::new(style, strands);
        let base = style.look.absorption().map(|a| (-4.2 * a.sqrt()).exp());
        let mut canvas = self.body(scalp, body, base, &shadow);
        let width = style.look.shadow_width(strands.count()) * style.look.width_scale / PIXEL * FINE as f32;
        for s in 0..strands.count() {
            let points = strands.first_point[s] as usize..strands.first_point[s + 1] as usize;
            let tint = 1.0 + style.look.variation * (1.6 * style.strands.shade[s] - 0.8);
            for i in points.start..points.end - 1 {
                let (a, b) = (strands.point(i), strands.point(i + 1));
                let tangent = (b - a).normalize_or(Vec3::Y);
                let along = (i - points.start) as f32 / points.len() as f32;
                let tip = 1.0 + style.look.tip_lightening * along;
                let color = self.shade(style, base * tint * tip, a, tangent, &shadow);
                canvas.line(self.project(a), self.project(b), 0.5 * width * style.strands.taper[i], color);
            }
        }
        canvas.reduced()
    }

    /// The light from a hair at `p` toward the camera.
    fn shade(&self, style: &Hairstyle, base: Vec3, p: Vec3, tangent: Vec3, shadow: &Shadow) -> Vec3 {
        let lit = shadow.transmittance(p, self.light);
        let sky = shadow.transmittance(p, Vec3::Y).mul_add(0.5, 0.5 * shadow.transmittance(p, self.back));
        let diffuse = 1.0 - tangent.dot(self.light).powi(2);
        let half = (self.light + self.back).normalize_or(self.back);
        let lobe = |shift: f32, width: f32| {
            let s = tangent.dot(half) + shift;
            (-s * s / (width * width)).exp()
        };
        let rough = style.look.roughness;
        let first = Vec3::splat(0.10 * style.look.primary_strength * lobe(0.08, 0.45 * rough));
        let second = base.map(f32::sqrt) * (0.35 * style.look.secondary_strength * lobe(-0.12, rough));
        (base * (1.6 * diffuse.max(0.0).sqrt()) + first + second) * lit + base * (0.12 + 0.7 * sky)
    }

    /// The skin, by ray marching for each pixel.
    fn body(&self, scalp: &Scalp, body: &dyn Obstacle, hair: Vec3, shadow: &Shadow) -> Canvas {
        let index = ScalpIndex::new(scalp);
        let mut canvas = Canvas::new();
        for i in 0..VIEW[0] * VIEW[1] {
            let (x, y) = ((i % VIEW[0]) as f32 + 0.5, (i / VIEW[0]) as f32 + 0.5);
            let across = (x - 0.5 * VIEW[0] as f32) * PIXEL;
            let along = (0.5 * VIEW[1] as f32 - y) * PIXEL;
            let eye = self.centre + self.right * across + self.up * along + self.back * 0.5;
            let (mut far, mut distance, mut n) = (0.0, 1.0, Vec3::Y);
            for _ in 0..40 {
                (distance, n) = body.distance(eye - self.back * far);
                if distance < 4e-4 || far > 1.2 {
                    break;
                }
                far += distance * 0.9;
            }
            let sky = (Vec3::new(0.30, 0.32, 0.35) * (1.15 - 0.5 * y / VIEW[1] as f32), -10.0);
            let skin = || {
                let p = eye - self.back * far;
                let near = index.closest_within(p, 0.006);
                let skin = Vec3::new(0.62, 0.42, 0.33).lerp(hair * 0.7, near.map_or(0.0, |s| s.mask));
                let lit = n.dot(self.light).max(0.0) * shadow.transmittance(p + n * 0.008, self.light);
                (skin * (0.28 + 0.9 * lit + 0.12 * n.y), 0.5 - far)
            };
            canvas.fill(i, if distance < 4e-4 { skin() } else { sky });
        }
        canvas
    }
}

/// A depth buffer and colours with `FINE` samples along each side of a pixel.
struct Canvas {
    color: Vec<Vec3>,
    depth: Vec<f32>,
}

impl Canvas {
    fn new() -> Self {
        let count = VIEW[0] * VIEW[1] * FINE * FINE;
        Self { color: vec![Vec3::ZERO; count], depth: vec![-10.0; count] }
    }

    /// Sets all samples of pixel `i`.
    fn fill(&mut self, i: usize, (color, depth): (Vec3, f32)) {
        for k in 0..FINE * FINE {
            let at = Self::sample(i, k);
            (self.color[at], self.depth[at]) = (color, depth);
        }
    }

    /// The position of sample `k` of pixel `i`.
    fn sample(i: usize, k: usize) -> usize {
        ((i / VIEW[0]) * FINE + k / FINE) * VIEW[0] * FINE + (i % VIEW[0]) * FINE + k % FINE
    }

    fn line(&mut self, a: Vec3, b: Vec3, radius: f32, color: Vec3) {
        let along = b - a;
        let steps = along.truncate().abs().max_element().ceil().max(1.0);
        let mostly_down = along.y.abs() > along.x.abs();
        let length = along.truncate().length().max(1e-6);
        // The pixel width along the minor axis for this width perpendicular to the line.
        let across = radius * length / along.truncate().abs().max_element().max(1e-6);
        for k in 0..=steps as usize {
            let p = a + along * (k as f32 / steps);
            let middle = if mostly_down { p.x } else { p.y };
            for q in (middle - across).round() as i32
                ..=((middle + across).round() as i32 - 1).max((middle - across).round() as i32)
            {
                let (x, y) = if mostly_down { (q, p.y as i32) } else { (p.x as i32, q) };
                let inside =
                    x >= 0 && y >= 0 && (x as usize) < VIEW[0] * FINE && (y as usize) < VIEW[1] * FINE;
                let at = if inside { y as usize * VIEW[0] * FINE + x as usize } else { continue };
                if p.z > self.depth[at] {
                    self.depth[at] = p.z;
                    self.color[at] = color;
                }
            }
        }
    }

    fn reduced(&self) -> Vec<Vec3> {
        let sum =
            |i| (0..FINE * FINE).map(|k| self.color[Self::sample(i, k)]).sum::<Vec3>() / (FINE * FINE) as f32;
        (0..VIEW[0] * VIEW[1]).map(sum).collect()
    }
}

/// Extinction of the hair in cells, per metre.
struct Shadow(Vec<f32>);

impl Shadow {
    fn new(style: &Hairstyle, strands: &Strands) -> Self {
        let mut cells = vec![0.0; GRID * GRID * GRID];
        let area = style.look.shadow_width(strands.count()) * EXTINCTION;
        for s in 0..strands.count() {
            for i in strands.first_point[s] as usize..strands.first_point[s + 1] as usize - 1 {
                let (a, b) = (strands.point(i), strands.point(i + 1));
                if let Some(cell) = Self::cell(0.5 * (a + b)) {
                    cells[cell] += area * a.distance(b) / (CELL * CELL * CELL);
                }
            }
        }
        Self(cells)
    }

    fn cell(p: Vec3) -> Option<usize> {
        let q = (p + Vec3::new(0.45, 0.6, 0.45)) / CELL;
        let inside = q.cmpge(Vec3::ZERO).all() && q.cmplt(Vec3::splat(GRID as f32)).all();
        inside.then(|| (q.z as usize * GRID + q.y as usize) * GRID + q.x as usize)
    }

    fn transmittance(&self, p: Vec3, toward_light: Vec3) -> f32 {
        let depth: f32 = (1..40)
            .map_while(|k| Self::cell(p + toward_light * (k as f32 * CELL)))
            .map(|cell| self.0[cell] * CELL)
            .sum();
        (-depth).exp()
    }
}

/// A soft shoulder, then the sRGB curve.
fn to_srgb(linear: Vec3) -> [u8; 3] {
    let shown = linear.map(|c| (c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14));
    shown.clamp(Vec3::ZERO, Vec3::ONE).to_array().map(|c| {
        let s = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (s * 255.0 + 0.5) as u8
    })
}
