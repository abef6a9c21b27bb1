//! Test images for FLIP, one for each kind of difference.

use anyhow::Context as _;
use std::fs;
use std::path::Path;

/// An image, sRGB, four bytes per pixel.
pub(super) struct Picture {
    name: &'static str,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) rgba: Vec<u8>,
}

impl Picture {
    fn of(name: &'static str, width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 3]) -> Self {
        let bytes = |i: u32| {
            let [r, g, b] = pixel(i % width, i / width);
            [r, g, b, 255]
        };
        Self { name, width, height, rgba: (0..width * height).flat_map(bytes).collect() }
    }

    /// Thin strands, the same strands moved by a pixel and in another colour, a colour gradient, noise, and a narrow strip.
    pub(super) fn all() -> Vec<Self> {
        // Curves as thin as hair: a pixel is on a strand if its distance to a wave is small.
        let strands = |x: u32, y: u32| {
            let wave = (f64::from(y) / 23.0).sin() * 9.0 + f64::from(x);
            if wave.rem_euclid(7.0) < 1.4 { [168, 117, 72] } else { [34, 24, 20] }
        };
        let noise = |x: u32, y: u32| {
            let hash =
                (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(2_246_822_519)).wrapping_mul(3_266_489_917);
            [(hash >> 24) as u8, (hash >> 16) as u8, (hash >> 8) as u8]
        };
        let (width, height) = (192, 128);
        vec![
            Self::of("strands", width, height, strands),
            Self::of("strands_moved", width, height, move |x, y| strands(x + 1, y)),
            Self::of("strands_lit", width, height, move |x, y| strands(x, y).map(|c| c.saturating_add(30))),
            Self::of("slow", width, height, |x, y| [(x * 255 / 191) as u8, (y * 2) as u8, 128]),
            Self::of("noise", width, height, noise),
            Self::of("strip", 300, 5, move |x, y| strands(x * 2, y)),
            Self::of("strip_slow", 300, 5, |x, _| [90, (x * 255 / 299) as u8, 60]),
        ]
    }

    pub(super) fn file(&self) -> String {
        format!("{}.png", self.name)
    }

    /// Writes the image as a PNG file into `folder`.
    pub(super) fn save(&self, folder: &Path) -> anyhow::Result<()> {
        fs::create_dir_all(folder)?;
        let path = folder.join(self.file());
        // The other program requires images without alpha.
        let rgb: Vec<u8> = self.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        image::save_buffer(&path, &rgb, self.width, self.height, image::ColorType::Rgb8)
            .with_context(|| format!("could not write {}", path.display()))
    }
}
