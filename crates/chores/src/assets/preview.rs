//! A small software rasteriser for previews of the figure, independent of the rest of the project.

use std::path::Path;

use glam::{Vec2, Vec3, Vec4};
use image::RgbImage;

/// What to draw: a mesh with colours, as one surface.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    /// World positions, metres.
    pub(super) positions: &'a [Vec3],
    /// Unit normals.
    pub(super) normals: &'a [Vec3],
    /// Linear sRGB.
    pub(super) colours: &'a [Vec3],
    /// Texture coordinates.
    pub(super) uv: &'a [Vec2],
    /// Vertex indices, and the index of the texture.
    pub(super) triangles: &'a [([u32; 3], Option<usize>)],
    /// The textures.
    pub(super) textures: &'a [RgbImage],
}

impl View<'_> {
    /// The colour of a texture, linear sRGB.
    fn texel(&self, texture: Option<usize>, uv: Vec2) -> Vec3 {
        let Some(image) = texture.map(|t| &self.textures[t]) else { return Vec3::ONE };
        let (w, h) = image.dimensions();
        let at = (uv * Vec2::new(w as f32, h as f32)).max(Vec2::ZERO).as_uvec2();
        let pixel = image.get_pixel(at.x.min(w - 1), at.y.min(h - 1)).0;
        Vec3::from(pixel.map(|v| (f32::from(v) / 255.0).powf(2.2)))
    }
}

/// Position and target of the camera in metres, and its vertical field of view in radians.
pub(super) type Camera = (Vec3, Vec3, f32);

/// An image in linear sRGB with depth, rows from the top.
pub(super) struct Canvas {
    width: usize,
    height: usize,
    colour: Vec<Vec3>,
    depth: Vec<f32>,
}

impl Canvas {
    /// An empty image with a soft background.
    pub(super) fn new(width: usize, height: usize) -> Self {
        let colour = (0..width * height)
            .map(|i| Vec3::new(0.16, 0.17, 0.19) * (1.1 - 0.5 * (i / width) as f32 / height as f32))
            .collect();
        Self { width, height, colour, depth: vec![f32::INFINITY; width * height] }
    }

    /// Draws into the rectangle at `(left, top)` of `width` by `height` pixels, with every pixel sampled four times.
    pub(super) fn draw(&mut self, view: &View, camera: Camera, rectangle: [usize; 4]) {
        let [left, top, width, height] = rectangle;
        let (eye, target, angle) = camera;
        let scale = 2;
        let (w, h) = (width * scale, height * scale);
        let back = (eye - target).normalize_or(Vec3::Z);
        let right = Vec3::Y.cross(back).normalize_or(Vec3::X);
        let up = back.cross(right);
        let focal = 0.5 * h as f32 / (0.5 * angle).tan();
        let projected: Vec<Vec4> = view
            .positions
            .iter()
            .map(|p| {
                let q = *p - eye;
                let away = (-q.dot(back)).max(0.05);
                let (x, y) = (q.dot(right) * focal / away, q.dot(up) * focal / away);
                Vec4::new(0.5 * w as f32 + x, 0.5 * h as f32 - y, away, 1.0 / away)
            })
            .collect();
        let mut depth = vec![f32::INFINITY; w * h];
        let mut colour = vec![None; w * h];
        for (triangle, texture) in view.triangles {
            let [a, b, c] = triangle.map(|i| projected[i as usize]);
            let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
            if area >= 0.0 {
                continue; // Seen from behind: y grows downward here.
            }
            let low = a.min(b).min(c);
            let high = a.max(b).max(c);
            for y in (low.y.max(0.0) as usize)..=(high.y.max(0.0) as usize).min(h - 1) {
                for x in (low.x.max(0.0) as usize)..=(high.x.max(0.0) as usize).min(w - 1) {
                    let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
                    let edge =
                        |p: Vec4, q: Vec4| ((q.x - p.x) * (py - p.y) - (q.y - p.y) * (px - p.x)) / area;
                    let weights = [edge(b, c), edge(c, a), edge(a, b)];
                    if weights.iter().any(|v| *v < 0.0) {
                        continue;
                    }
                    let inverse = [a.w, b.w, c.w];
                    let z = 1.0 / (0..3).map(|i| weights[i] * inverse[i]).sum::<f32>();
                    if z >= depth[y * w + x] {
                        continue;
                    }
                    depth[y * w + x] = z;
                    let mix = |of: &[Vec3]| -> Vec3 {
                        (0..3).map(|i| of[triangle[i] as usize] * (weights[i] * inverse[i] * z)).sum()
                    };
                    let normal = mix(view.normals).normalize_or(Vec3::Y);
                    let uv: Vec2 =
                        (0..3).map(|i| view.uv[triangle[i] as usize] * (weights[i] * inverse[i] * z)).sum();
                    let surface = mix(view.colours) * view.texel(*texture, uv);
                    colour[y * w + x] = Some(surface * light(normal, eye - mix(view.positions)));
                }
            }
        }
        for y in 0..height {
            for x in 0..width {
                let at = (top + y) * self.width + left + x;
                let ground = self.colour[at];
                let mut sum = Vec3::ZERO;
                for s in 0..scale * scale {
                    sum += colour[(y * scale + s / scale) * w + x * scale + s % scale].unwrap_or(ground);
                }
                self.colour[at] = sum / (scale * scale) as f32;
                self.depth[at] = depth[y * scale * w + x * scale];
            }
        }
    }

    /// Writes the image as PNG.
    pub(super) fn save(&self, path: &Path) -> anyhow::Result<()> {
        let mut image = image::RgbImage::new(self.width as u32, self.height as u32);
        for (pixel, c) in image.pixels_mut().zip(&self.colour) {
            let encode = |v: f32| {
                let v = (v * 1.25).clamp(0.0, 1.0);
                let s = if v < 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
                (s * 255.0 + 0.5) as u8
            };
            *pixel = image::Rgb([encode(c.x), encode(c.y), encode(c.z)]);
        }
        image.save(path)?;
        Ok(())
    }
}

/// A warm key light from the upper left, a cool fill light and a rim light, all diffuse, with a weak sheen.
fn light(normal: Vec3, to_eye: Vec3) -> Vec3 {
    let key_dir = Vec3::new(-0.55, 0.65, 0.60).normalize_or(Vec3::Y);
    let key = normal.dot(key_dir).max(0.0);
    let fill = normal.dot(Vec3::new(0.8, 0.1, 0.5).normalize_or(Vec3::Y)).max(0.0);
    let rim = normal.dot(Vec3::new(0.3, 0.4, -0.8).normalize_or(Vec3::Y)).max(0.0);
    let sky = 0.5 + 0.5 * normal.y;
    let half = (key_dir + to_eye.normalize_or(Vec3::Z)).normalize_or(Vec3::Y);
    let sheen = 0.06 * normal.dot(half).max(0.0).powi(12);
    Vec3::new(1.05, 1.0, 0.92) * (key + sheen)
        + Vec3::new(0.10, 0.13, 0.18) * fill
        + Vec3::new(0.25, 0.27, 0.30) * rim
        + Vec3::new(0.13, 0.15, 0.18) * sky
        + Vec3::splat(0.05)
}
