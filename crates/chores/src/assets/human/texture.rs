//! The texture of the skin: computed for every texel from the place on the figure and the masks of the package.

use glam::{Vec2, Vec3};
use image::codecs::jpeg::JpegEncoder;
use image::{GrayImage, RgbImage};
use lovelock_base::numbers::smoothstep;
use rayon::prelude::*;

use super::marks::Marks;
use super::noise::noise;
use super::recipe::Look;
use super::source::Source;
use super::surface::Surface;
use crate::assets::rig;

/// Quality of the JPEG images.
const QUALITY: u8 = 90;
/// The roughness of the skin of the body.
const DRY: f32 = 0.60;
/// Rings of texels that are filled around the parts of the texture, against seams in smaller versions of it.
const BLEED: usize = 12;

/// A linear colour in sRGB.
pub(super) fn encode(colour: Vec3) -> [u8; 3] {
    colour.to_array().map(|v| {
        let v = v.clamp(0.0, 1.0);
        let s = if v < 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        (s * 255.0 + 0.5) as u8
    })
}

/// The bytes of an image as JPEG.
pub(super) fn jpeg(image: &RgbImage) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, QUALITY).encode_image(image)?;
    Ok(bytes)
}

/// The masks of the package that are used.
pub(super) struct Masks {
    lips: GrayImage,
    lids: GrayImage,
    ears: GrayImage,
    mouth: GrayImage,
    nails: [GrayImage; 2],
}

impl Masks {
    /// Reads them.
    pub(super) fn read(source: &Source) -> anyhow::Result<Self> {
        Ok(Self {
            lips: source.mask("lips")?,
            lids: source.mask("eyelids")?,
            ears: source.mask("ears")?,
            mouth: source.mask("inside-mouth")?,
            nails: [source.mask("fingernails")?, source.mask("toenails")?],
        })
    }

    /// Whether texture coordinates are those of an ear.
    pub(super) fn is_ear(&self, uv: Vec2) -> bool {
        sample(&self.ears, uv) > 0.5
    }
}

/// The value of a mask, 0 to 1.
fn sample(mask: &GrayImage, uv: Vec2) -> f32 {
    let (w, h) = mask.dimensions();
    let at = uv * Vec2::new(w as f32, h as f32) - 0.5;
    let base = at.floor();
    let t = at - base;
    let pixel = |dx: f32, dy: f32| {
        let x = (base.x + dx).clamp(0.0, w as f32 - 1.0) as u32;
        let y = (base.y + dy).clamp(0.0, h as f32 - 1.0) as u32;
        f32::from(mask.get_pixel(x, y).0[0]) / 255.0
    };
    let row = |dy: f32| pixel(0.0, dy) * (1.0 - t.x) + pixel(1.0, dy) * t.x;
    row(0.0) * (1.0 - t.y) + row(1.0) * t.y
}

/// What is known at a texel.
#[derive(Clone, Copy, Default)]
struct Texel {
    place: Vec3,
    normal: Vec3,
    uv: Vec2,
    hand: f32,
}

/// The skin of a figure.
pub(super) struct Paint<'a> {
    /// The colours.
    pub(super) look: &'a Look,
    /// Where the parts of the face are.
    pub(super) marks: &'a Marks,
    /// The masks.
    pub(super) masks: &'a Masks,
    /// Roots of the upper and of the lower lashes.
    pub(super) lashes: [&'a [Vec3]; 2],
    /// How old the figure is, 0 to 1.
    pub(super) old: f32,
}

impl Paint<'_> {
    /// The colour by which the texture is multiplied, so that the figure has its tone without it.
    pub(super) fn factor(&self) -> Vec3 {
        let look = self.look;
        (look.skin.max(look.blush).max(look.pale) * 1.2).min(Vec3::ONE)
    }

    /// Draws the texture.
    pub(super) fn draw(&self, skin: &Surface, size: u32) -> RgbImage {
        let texels = rasterize(skin, size);
        let factor = self.factor();
        let mut colours: Vec<Option<Vec3>> =
            texels.par_iter().map(|t| t.map(|t| self.colour(&t) / factor)).collect();
        bleed(&mut colours, size as usize);
        let rest = self.look.skin / factor;
        RgbImage::from_fn(size, size, |x, y| {
            image::Rgb(encode(colours[(y * size + x) as usize].unwrap_or(rest)))
        })
    }

    /// Draws the perceptual roughness of the skin into green, as glTF stores it.
    pub(super) fn draw_roughness(&self, skin: &Surface, size: u32) -> RgbImage {
        let texels = rasterize(skin, size);
        let mut values: Vec<Option<Vec3>> =
            texels.par_iter().map(|t| t.map(|t| Vec3::splat(self.roughness(&t)))).collect();
        bleed(&mut values, size as usize);
        RgbImage::from_fn(size, size, |x, y| {
            let rough = values[(y * size + x) as usize].map_or(DRY, |v| v.y);
            image::Rgb([255, (rough.clamp(0.0, 1.0) * 255.0 + 0.5) as u8, 0])
        })
    }

    /// Lips and lids are moist; forehead, nose and chin have more oil than cheeks, and those more than the body.
    fn roughness(&self, t: &Texel) -> f32 {
        let (marks, masks, p) = (self.marks, self.masks, t.place);
        let near = |at: Vec3, width: f32| (-(p - at).length_squared() / (width * width)).exp();
        let (eye, nose) = (marks.eye, marks.nose);
        let forehead = Vec3::new(0.0, eye.y + 0.048, nose.z - 0.024);
        let oil = near(forehead, 0.034) + near(nose, 0.020) + 0.7 * near(nose - Vec3::Y * 0.055, 0.020);
        let face = smoothstep(-0.10, -0.04, p.y - eye.y) * smoothstep(-0.02, 0.03, p.z - marks.skull_z);
        let dry = DRY - 0.05 * face + 0.03 * noise(p * 420.0);
        let mut rough = dry + (0.46 - dry) * oil.min(1.0);
        for (mask, value) in [(&masks.lids, 0.46), (&masks.lips, 0.36), (&masks.mouth, 0.25)] {
            rough += (value - rough) * smoothstep(0.1, 0.9, sample(mask, t.uv));
        }
        let nail = masks.nails.iter().map(|m| sample(m, t.uv)).fold(0.0, f32::max);
        rough + (0.34 - rough) * nail
    }

    fn colour(&self, t: &Texel) -> Vec3 {
        let (look, marks, p) = (self.look, self.marks, t.place);
        let near = |at: Vec3, width: f32| {
            let q = Vec3::new(p.x.abs(), p.y, p.z);
            (-(q - at).length_squared() / (width * width)).exp()
        };
        // Blood: broad patches over the body, and the parts of the face that are always redder.
        let patches = 0.10 * noise(p * 38.0) + 0.08 * noise(p * 90.0 + 11.0) + 0.05 * noise(p * 260.0 + 5.0);
        let (eye, nose) = (marks.eye, marks.nose);
        let cheek = Vec3::new(eye.x * 1.32, 0.62 * nose.y + 0.38 * eye.y - 0.004, nose.z - 0.034);
        let masks = self.masks;
        let lids = sample(&masks.lids, t.uv);
        let blood = 0.34 * near(cheek, 0.022)
            + 0.30 * near(nose, 0.012)
            + 0.10 * near(nose - Vec3::Y * 0.055, 0.016)
            + 0.30 * sample(&masks.ears, t.uv)
            + 0.22 * lids
            + 0.16 * t.hand * smoothstep(0.1, 0.5, noise(p * 55.0 + 3.0).abs())
            + knees(p, marks)
            + look.variation * patches;
        let mut c = look.skin.lerp(look.blush, blood.clamp(-0.2, 0.8));
        // Light and dark of the tone, fine enough to be no pattern.
        let grain =
            0.030 * noise(p * 900.0) + 0.030 * noise(p * 420.0 + 2.0) + 0.025 * noise(p * 150.0 + 9.0);
        c *= 1.0 + look.variation * grain;
        if self.old > 0.0 {
            let spots =
                smoothstep(0.52, 0.68, noise(p * 210.0 + 21.0)) * smoothstep(-0.2, 0.4, noise(p * 30.0));
            c *= 1.0 - 0.22 * self.old * spots;
        }
        // Around the eyes the skin is thin and darker.
        let socket = near(eye + Vec3::new(0.0, -0.013, marks.eye_radius), 0.016);
        c *= Vec3::ONE - Vec3::new(0.10, 0.14, 0.13) * socket * (0.8 + 0.8 * self.old);
        // Palms, soles and nails.
        let palm = t.hand * smoothstep(0.2, 0.6, -0.77 * t.normal.x * p.x.signum() - 0.63 * t.normal.y);
        let sole = smoothstep(-0.55, -0.85, t.normal.y) * smoothstep(0.05, 0.02, p.y);
        c = c.lerp(look.pale, palm.max(sole));
        let nail = masks.nails.iter().map(|m| sample(m, t.uv)).fold(0.0, f32::max);
        c = c.lerp(look.pale.lerp(look.lips, 0.25), 0.8 * nail);
        // Lips, with fine lines up and down.
        let lines = 1.0 + 0.10 * noise(Vec3::new(p.x * 1300.0, p.y * 160.0, 4.0));
        c = c.lerp(look.lips * lines, 0.78 * smoothstep(0.10, 0.90, sample(&masks.lips, t.uv)));
        c = c.lerp(look.lips * 0.22, sample(&masks.mouth, t.uv));
        // The line from which the lashes grow, and the wet inner edge of the lids.
        let dark = Vec3::new(0.020, 0.012, 0.009);
        for (roots, (strength, width)) in self.lashes.into_iter().zip([(0.80, 0.0017), (0.35, 0.0011)]) {
            if p.distance(eye.with_x(eye.x.copysign(p.x))) < 2.2 * marks.eye_radius {
                let pairs = roots.windows(2).filter(|pair| pair[0].distance(pair[1]) < 0.008);
                let away = pairs.map(|pair| to_segment(p, pair[0], pair[1])).fold(f32::MAX, f32::min);
                c = c.lerp(dark, strength * smoothstep(width, 0.35 * width, away));
            }
        }
        // The skin is a little darker where brows grow.
        c * (1.0 - 0.10 * marks.brow(p))
    }
}

/// Distance from a point to the line between two others.
fn to_segment(p: Vec3, a: Vec3, b: Vec3) -> f32 {
    let t = (p - a).dot(b - a) / (b - a).length_squared().max(1e-12);
    p.distance(a.lerp(b, t.clamp(0.0, 1.0)))
}

/// A little blood on the knees.
fn knees(p: Vec3, marks: &Marks) -> f32 {
    let knee = Vec3::new(marks.hip.x, 0.52 * (marks.hip.y + marks.ankle.y), marks.hip.z + 0.05);
    0.15 * (-(Vec3::new(p.x.abs(), p.y, p.z) - knee).length_squared() / 0.0025).exp()
}

/// The places of the texels on the surface.
fn rasterize(skin: &Surface, size: u32) -> Vec<Option<Texel>> {
    let mut out = vec![None; (size * size) as usize];
    let scale = size as f32;
    for (t, uv) in skin.triangles.iter().zip(&skin.uv) {
        let [a, b, c] = uv.map(|q| q * scale);
        let area = (b - a).perp_dot(c - a);
        if area.abs() < 1e-9 {
            continue;
        }
        let low = a.min(b).min(c).floor().max(Vec2::ZERO);
        let high = a.max(b).max(c).ceil().min(Vec2::splat(scale));
        for y in low.y as u32..high.y as u32 {
            for x in low.x as u32..high.x as u32 {
                let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let w = [(b - p).perp_dot(c - p), (c - p).perp_dot(a - p), (a - p).perp_dot(b - p)];
                let w = w.map(|v| v / area);
                if w.iter().any(|v| *v < -0.02) {
                    continue;
                }
                let mut texel = Texel { uv: p / scale, ..Texel::default() };
                for (vertex, w) in t.iter().zip(w) {
                    let vertex = &skin.vertices[*vertex as usize];
                    texel.place += vertex.place * w;
                    texel.normal += vertex.normal * w;
                    let hand = rig::CLAVICLE + rig::HAND;
                    texel.hand += (vertex.weights[hand] + vertex.weights[hand + rig::ARM_JOINTS]) * w;
                }
                out[(y * size + x) as usize] = Some(texel);
            }
        }
    }
    out
}

/// Fills empty texels beside others with the mean of those.
fn bleed(colours: &mut [Option<Vec3>], size: usize) {
    for _ in 0..BLEED {
        let before = colours.to_vec();
        for y in 0..size {
            for x in 0..size {
                if before[y * size + x].is_some() {
                    continue;
                }
                let (mut sum, mut count) = (Vec3::ZERO, 0.0);
                for (dx, dy) in [(0, 1), (2, 1), (1, 0), (1, 2)] {
                    let (u, v) = ((x + dx).wrapping_sub(1), (y + dy).wrapping_sub(1));
                    if let Some(c) = (u < size && v < size).then(|| before[v * size + u]).flatten() {
                        sum += c;
                        count += 1.0;
                    }
                }
                if count > 0.0 {
                    colours[y * size + x] = Some(sum / count);
                }
            }
        }
    }
}
