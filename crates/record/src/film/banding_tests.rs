//! Bands in the dark backdrop of a film, with and without dithering.

use super::encoder::FrameEncoder;
use super::{FilmQuality, FilmSettings};
use crate::FilmReader;
use crate::dither::Dither;
use crate::mp4::{Mp4Writer, Track};
use std::fs::File;

const WIDTH: u32 = 256;
const HEIGHT: u32 = 192;
const FRAMES: usize = 20;

/// A backdrop that brightens from sRGB 36 at the top to 84 at the bottom, rounded to 8 bits with the noise of the renderer.
fn backdrop() -> Vec<u8> {
    let noise = |x: u32, y: u32| {
        (52.982_918 * (x as f32 * 0.067_110_56 + y as f32 * 0.005_837_15).fract()).fract() - 0.5
    };
    let pixel = |x: u32, y: u32| {
        let value = 36.0 + 48.0 * y as f32 / HEIGHT as f32 + noise(x, y);
        let code = |offset: f32| (value + offset).round() as u8;
        [code(-2.0), code(0.0), code(7.0), 255]
    };
    (0..HEIGHT).flat_map(|y| (0..WIDTH).flat_map(move |x| pixel(x, y))).collect()
}

/// Writes a film of the backdrop, and returns its length in bytes and the luma of its decoded frames, 0 to 255.
fn film(quality: FilmQuality, dither: Dither) -> (u64, Vec<Vec<f32>>) {
    let settings = FilmSettings { width: WIDTH, height: HEIGHT, fps: 30.0, quality };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.mp4");
    let track =
        Track { width: WIDTH as u16, height: HEIGHT as u16, ticks_per_second: 12_000, ticks_per_frame: 400 };
    let mut encoder = FrameEncoder::new(settings, settings.check().unwrap(), dither).unwrap();
    let mut writer = Mp4Writer::new(File::create(&path).unwrap(), track).unwrap();
    let image = backdrop();
    for _ in 0..FRAMES {
        let (sample, key) = encoder.encode(&image).unwrap();
        writer.write_frame(sample, key).unwrap();
    }
    let (_, bytes) = writer.finish(encoder.config()).unwrap();
    let mut reader = FilmReader::open(&path).unwrap();
    let (mut rgba, mut frames) = (Vec::new(), Vec::new());
    while reader.next_frame(&mut rgba).unwrap() {
        let luma = |pixel: &[u8]| {
            0.2126 * f32::from(pixel[0]) + 0.7152 * f32::from(pixel[1]) + 0.0722 * f32::from(pixel[2])
        };
        frames.push(rgba.chunks_exact(4).map(luma).collect());
    }
    (bytes, frames)
}

/// How the mean luma of the rows rises from the top to the bottom of an image.
struct Profile {
    /// Mean absolute second difference: 0 for a smooth gradient.
    bend: f32,
    /// Rows that are as bright as the row above them, of all: the inside of bands.
    flat: f32,
}

fn profile(luma: &[f32]) -> Profile {
    let rows: Vec<f32> =
        luma.chunks_exact(WIDTH as usize).map(|row| row.iter().sum::<f32>() / row.len() as f32).collect();
    let bends = rows.windows(3).map(|rows| (rows[0] - 2.0 * rows[1] + rows[2]).abs());
    // The gradient rises by a quarter of a code per row.
    let flat = rows.windows(2).filter(|rows| (rows[1] - rows[0]).abs() < 0.025).count();
    Profile { bend: bends.sum::<f32>() / rows.len() as f32, flat: flat as f32 / rows.len() as f32 }
}

/// The dither survives the encoder, and costs little. The control is the same film without it.
#[test]
fn dithering_breaks_up_bands() {
    for quality in [FilmQuality::Good, FilmQuality::High, FilmQuality::Best] {
        let (plain_bytes, plain) = film(quality, Dither::none());
        let (bytes, dithered) = film(quality, Dither::for_quantiser(quality.quantiser()));
        let (before, after) = (profile(&plain[FRAMES - 1]), profile(&dithered[FRAMES - 1]));
        let found = format!(
            "{quality:?}: bend {:.3} → {:.3}, flat rows {:.3} → {:.3}, bytes {plain_bytes} → {bytes}",
            before.bend, after.bend, before.flat, after.flat
        );
        assert!(before.flat > 0.5 && after.flat < 0.4 * before.flat, "{found}");
        assert!(after.bend < before.bend, "{found}");
        // Half a bit per pixel of the key frame, of which there is one per second.
        assert!((bytes - plain_bytes) * 16 < u64::from(WIDTH * HEIGHT), "{found}");
    }
}

/// The noise does not depend on time: after the key frame nothing moves in a still image.
#[test]
fn still_backdrops_stay_still() {
    let (_, frames) = film(FilmQuality::High, Dither::for_quantiser(20));
    // The encoder refines the key frame in the next one.
    for pair in frames[2..].windows(2) {
        assert!(pair[0] == pair[1]);
    }
}
