//! The light from all directions against answers known on paper, and its files against damage.

mod axes;
mod backdrop;
mod files;
mod mutations;
mod reduction;
mod strongest;
mod surround;

use std::f32::consts::PI;
use std::io::Cursor;

use exr::prelude::{
    Blocks, Compression, Encoding, Image, LineOrder, SpecificChannels, Vec2, WritableImage as _,
};
use glam::Vec3;
use image::Rgb;
use image::codecs::hdr::HdrEncoder;

use super::Panorama;

/// The part of the expected value by which single precision may differ.
const ROUNDING: f32 = 2e-5;

/// Numbers that look random and are equal in every run.
struct Numbers(u64);

impl Numbers {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.bits() % limit as u64) as usize
    }

    fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1_u64 << 24) as f32
    }

    fn colour(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }
}

/// Directions over the sphere, with the axes among them.
fn normals() -> Vec<Vec3> {
    let mut numbers = Numbers(7);
    let mut normals = vec![Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    for _ in 0..60 {
        let (y, azimuth) = (2.0 * numbers.unit() - 1.0, 2.0 * PI * numbers.unit());
        let across = (1.0 - y * y).sqrt();
        normals.push(Vec3::new(across * azimuth.sin(), y, across * azimuth.cos()));
    }
    normals
}

/// A picture of uniform noise.
fn noise(width: usize, height: usize) -> Vec<Vec3> {
    let mut numbers = Numbers(11);
    (0..width * height).map(|_| numbers.colour()).collect()
}

fn panorama(width: usize, height: usize, pixels: &[Vec3]) -> Panorama {
    Panorama::from_pixels(width, height, pixels).unwrap()
}

/// A black picture with one pixel of `radiance`, the unit vector to it, and its solid angle.
fn one_pixel(size: [usize; 2], at: [usize; 2], radiance: Vec3) -> (Vec<Vec3>, Vec3, f32) {
    let mut pixels = vec![Vec3::ZERO; size[0] * size[1]];
    pixels[at[1] * size[0] + at[0]] = radiance;
    let azimuth = PI - 2.0 * PI * (at[0] as f32 + 0.5) / size[0] as f32;
    let latitude = |rows: f32| PI * (0.5 - rows / size[1] as f32);
    let row = at[1] as f32;
    let (y, across) = latitude(row + 0.5).sin_cos();
    let solid = (latitude(row).sin() - latitude(row + 1.0).sin()) * 2.0 * PI / size[0] as f32;
    (pixels, Vec3::new(across * azimuth.sin(), y, across * azimuth.cos()), solid)
}

/// The pixels turned by whole columns: what was `columns` to the right comes to each column.
fn shifted(width: usize, pixels: &[Vec3], columns: usize) -> Vec<Vec3> {
    let mut pixels = pixels.to_vec();
    pixels.chunks_exact_mut(width).for_each(|row| row.rotate_left(columns));
    pixels
}

#[track_caller]
fn assert_near(found: Vec3, wanted: Vec3, tolerance: f32) {
    let scale = wanted.abs().max_element().max(1e-6);
    assert!((found - wanted).abs().max_element() <= tolerance * scale, "found {found}, wanted {wanted}");
}

/// The pixels as the `image` crate writes them to a Radiance file.
fn hdr(width: usize, height: usize, pixels: &[Vec3]) -> Vec<u8> {
    let pixels: Vec<Rgb<f32>> = pixels.iter().map(|p| Rgb(p.to_array())).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes).encode(&pixels, width, height).unwrap();
    bytes
}

/// The pixels as the `exr` crate writes them with 32 bits per sample.
fn exr_of(width: usize, height: usize, pixels: &[Vec3], compression: Compression, blocks: Blocks) -> Vec<u8> {
    let at = |at: Vec2<usize>| {
        let pixel = pixels[at.y() * width + at.x()];
        (pixel.x, pixel.y, pixel.z)
    };
    let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let channels = SpecificChannels::rgb(at);
    let image = Image::from_encoded_channels((width, height), encoding, channels);
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}
