//! Reading, joining and saving images.

use anyhow::{Context as _, bail};
use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use lovelock_metrics::{Canvas, Image};
use std::fs;
use std::ops::RangeInclusive;
use std::path::Path;

/// Images beside each other; more begin another row.
const COLUMNS: usize = 6;
/// Around each image, pixels.
const GAP: usize = 2;
/// Height of a label with the gap above it, pixels.
const LABEL: usize = Canvas::LINE + 3;
const PAPER: [u8; 3] = [255; 3];
const INK: [u8; 3] = [0; 3];

/// Qualities of JPEG. The best one that keeps the file small enough is used.
const QUALITIES: RangeInclusive<u8> = 75..=88;
/// The largest file, bytes. The manual in the program contains every image.
const MAX_BYTES: usize = 300 << 10;

/// Reads an image, without alpha.
pub(super) fn read(path: &Path) -> anyhow::Result<RgbImage> {
    let image = image::open(path).with_context(|| format!("could not read {}", path.display()))?;
    Ok(image.into_rgb8())
}

/// Joins images to rows on white, with labels below them unless all are empty.
pub(super) fn join(tiles: &[(&str, RgbImage)]) -> anyhow::Result<RgbImage> {
    join_in(COLUMNS, tiles)
}

/// As [`join`], with at most `columns` beside each other.
pub(super) fn join_in(columns: usize, tiles: &[(&str, RgbImage)]) -> anyhow::Result<RgbImage> {
    let [mut width, mut height] = [0_usize; 2];
    for (_, image) in tiles {
        width = width.max(image.width() as usize);
        height = height.max(image.height() as usize);
    }
    let has_labels = tiles.iter().any(|(label, _)| !label.is_empty());
    let across = width + 2 * GAP;
    let down = height + 2 * GAP + if has_labels { LABEL } else { 0 };
    let columns = tiles.len().clamp(1, columns.max(1));
    let mut canvas = Canvas::new(columns * across, tiles.len().div_ceil(columns) * down, PAPER);
    for (i, (label, image)) in tiles.iter().enumerate() {
        let (x, y) = (i % columns * across + GAP, i / columns * down + GAP);
        let rgba: Vec<u8> = image.as_raw().chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect();
        canvas.put(x as i32, y as i32, &Image::new(image.width(), image.height(), &rgba)?);
        let indent = width.saturating_sub(Canvas::text_width(label)) / 2;
        canvas.text((x + indent) as i32, (y + height + LABEL - Canvas::LINE) as i32, label, INK);
    }
    let rgb = canvas.rgba().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    RgbImage::from_raw(canvas.width() as u32, canvas.height() as u32, rgb)
        .context("the joined image has too few bytes")
}

/// Saves an image as PNG or JPEG, by the extension of `path`. Returns the size of the file in bytes.
pub(super) fn save(image: &RgbImage, path: &Path) -> anyhow::Result<usize> {
    let bytes = if path.extension().is_some_and(|extension| extension == "png") {
        let mut bytes = std::io::Cursor::new(Vec::<u8>::new());
        image.write_to(&mut bytes, image::ImageFormat::Png)?;
        bytes.into_inner()
    } else {
        jpeg(image, MAX_BYTES).with_context(|| path.display().to_string())?
    };
    fs::write(path, &bytes).with_context(|| format!("could not write {}", path.display()))?;
    Ok(bytes.len())
}

/// The file with the best quality that has at most `max_bytes`.
fn jpeg(image: &RgbImage, max_bytes: usize) -> anyhow::Result<Vec<u8>> {
    for quality in QUALITIES.rev() {
        let mut bytes = Vec::<u8>::new();
        JpegEncoder::new_with_quality(&mut bytes, quality).encode_image(image)?;
        if bytes.len() <= max_bytes {
            return Ok(bytes);
        }
    }
    bail!("found more at the lowest quality; must be at most {max_bytes} bytes")
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn images_stand_in_rows_with_labels_below() {
        let grey = |value| RgbImage::from_pixel(100, 40, Rgb([value; 3]));
        let tiles: Vec<_> = (0..7).map(|i| ("Dye", grey(10 * i))).collect();
        let joined = join(&tiles).expect("an image");
        assert_eq!(joined.dimensions(), (6 * 104, 2 * (44 + 19)));
        for (i, (x, y)) in [(50, 20), (154, 20), (258, 20), (362, 20), (466, 20), (570, 20), (50, 83)]
            .into_iter()
            .enumerate()
        {
            assert_eq!(joined.get_pixel(x, y).0, [10 * i as u8; 3], "{i}");
        }
        let dark = |x: u32| (45..61).any(|y| joined.get_pixel(x, y).0[0] < 100);
        assert!((2..102).any(dark), "a label");
        assert_eq!(joined.get_pixel(300, 100).0, [255; 3], "no eighth image");
        let plain: Vec<_> = (0..2).map(|_| ("", grey(0))).collect();
        assert_eq!(join(&plain).expect("an image").dimensions(), (208, 44));
    }

    #[test]
    fn a_large_image_gets_a_lower_quality() {
        let image = RgbImage::from_fn(64, 64, |x, y| Rgb([(x * 37 + y * 91) as u8, (x * y) as u8, y as u8]));
        let best = jpeg(&image, usize::MAX).expect("a file").len();
        assert_eq!(jpeg(&image, best).expect("a file").len(), best);
        assert!(jpeg(&image, best - 1).expect("a file").len() < best);
        let error = jpeg(&image, 100).expect_err("too small").to_string();
        assert!(error.contains("at most 100 bytes"), "{error}");
    }
}
