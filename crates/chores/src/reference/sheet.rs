//! The contact sheet: ours above, theirs below.

use super::images::LinearImage;
use anyhow::Context as _;
use lovelock_metrics::{Canvas, Image};
use std::path::Path;

/// Scenes side by side: the colours or lights of a hairstyle.
const COLUMNS: usize = 6;
/// The longest side of an image on the sheet, pixels.
const MAX_SIDE: u32 = 200;
/// Around images and text, pixels.
const GAP: usize = 4;
const LINE: usize = 20;
const PAPER: [u8; 3] = [24, 24, 26];
const INK: [u8; 3] = [220, 220, 220];

/// The images of all scenes, on a screen.
pub(super) struct Sheet {
    /// Our variants, then the path tracer.
    names: Vec<String>,
    tiles: Vec<Tile>,
}

struct Tile {
    name: String,
    side: [u32; 2],
    /// In the order of the names.
    images: Vec<Vec<u8>>,
}

impl Sheet {
    pub(super) fn new<'a>(variants: impl Iterator<Item = &'a str>) -> Self {
        Self { names: variants.chain(["path tracer"]).map(str::to_owned).collect(), tiles: Vec::new() }
    }

    /// Adds a scene: our images, and the path tracer's.
    pub(super) fn add(&mut self, name: &str, ours: &[LinearImage], theirs: &LinearImage) {
        let by = theirs.width.max(theirs.height).div_ceil(MAX_SIDE).max(1);
        let small: Vec<LinearImage> = ours.iter().chain([theirs]).map(|image| image.shrunk(by)).collect();
        let side = small.last().map_or([0; 2], |image| [image.width, image.height]);
        let images = small.iter().map(LinearImage::shown).collect();
        self.tiles.push(Tile { name: name.to_owned(), side, images });
    }

    /// Draws it: blocks of six scenes, a row per variant and one for the path tracer.
    fn draw(&self) -> anyhow::Result<Canvas> {
        let [width, height] = self
            .tiles
            .iter()
            .fold([0, 0], |[w, h], tile| [w.max(tile.side[0] as usize), h.max(tile.side[1] as usize)]);
        let rows = self.names.len();
        let columns = self.tiles.len().min(COLUMNS);
        let block = 2 * LINE + rows * (height + GAP);
        let blocks = self.tiles.len().div_ceil(COLUMNS);
        let legend = format!("from above: {}", self.names.join(", "));
        let across = (columns * (width + GAP)).max(Canvas::text_width(&legend)) + GAP;
        let mut canvas = Canvas::new(across, LINE + blocks * block + GAP, PAPER);
        canvas.text(GAP as i32, 2, &legend, INK);
        for (i, tile) in self.tiles.iter().enumerate() {
            let x = (GAP + i % COLUMNS * (width + GAP)) as i32;
            let y = LINE + i / COLUMNS * block;
            // The hairstyle above the rest, because long names do not fit.
            let (hair, rest) = tile.name.split_once('-').unwrap_or((&tile.name, ""));
            canvas.text(x, y as i32 + 2, hair, INK);
            canvas.text(x, (y + LINE) as i32, rest, INK);
            for (row, rgba) in tile.images.iter().enumerate() {
                let image = Image::new(tile.side[0], tile.side[1], rgba)?;
                canvas.put(x, (y + 2 * LINE + row * (height + GAP)) as i32, &image);
            }
        }
        Ok(canvas)
    }

    /// Writes it as a PNG file.
    pub(super) fn save(&self, path: &Path) -> anyhow::Result<()> {
        let canvas = self.draw()?;
        let rgb: Vec<u8> = canvas.rgba().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        let (width, height) = (canvas.width() as u32, canvas.height() as u32);
        image::save_buffer(path, &rgb, width, height, image::ColorType::Rgb8)
            .with_context(|| format!("could not write {}", path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ours_is_above_theirs() {
        let grey = |light: f32| LinearImage {
            width: 200,
            height: 10,
            pixels: vec![[light, light, light, 1.0]; 2000],
        };
        let mut sheet = Sheet::new(["plain"].into_iter());
        (0..7).for_each(|i| sheet.add(&format!("scene-{i}"), &[grey(1.0)], &grey(0.0)));
        let canvas = sheet.draw().expect("a sheet");
        let at = |x: usize, y: usize| canvas.rgba()[4 * (y * canvas.width() + x)];
        let block = 2 * LINE + 2 * (10 + GAP);
        for (x, y) in [(0, 0), (5, 0), (0, 1)] {
            let (x, y) = (GAP + x * (200 + GAP) + 100, LINE + y * block + 2 * LINE + 5);
            assert_eq!((at(x, y), at(x, y + 10 + GAP)), (255, 0), "{x}, {y}");
        }
    }
}
