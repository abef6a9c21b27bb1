//! A single image as a PNG file, and small ones as JPEG.

use std::io::Write;
use std::path::Path;

use image::codecs::jpeg::{JpegDecoder, JpegEncoder};
use image::{ExtendedColorType, ImageDecoder, ImageEncoder};
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};

use crate::RecordError;
use crate::partial::{PartialFile, open_file};

/// The keyword of a PNG file's text that names the program by which it was written, and that of a JPEG file's comment.
const SOFTWARE: &str = "Software";
const PROGRAM: &str = concat!("Lovelock ", env!("CARGO_PKG_VERSION"));

/// What every image of this program that is a file of its own contains: the name of the program, of any version.
pub const IMAGE_MARK: &[u8] = b"Software\0Lovelock ";

/// Adds [`IMAGE_MARK`] to a PNG file.
pub(crate) fn mark_png<W: Write>(encoder: &mut Encoder<'_, W>) -> Result<(), EncodingError> {
    encoder.add_text_chunk(SOFTWARE.to_owned(), PROGRAM.to_owned())
}

/// Adds [`IMAGE_MARK`] to a JPEG file, as a comment behind its first marker.
fn mark_jpeg(file: &mut Vec<u8>) {
    let text = format!("{SOFTWARE}\0{PROGRAM}");
    let length = (text.len() + 2) as u16;
    let comment = [0xff, 0xfe].into_iter().chain(length.to_be_bytes()).chain(text.into_bytes());
    drop(file.splice(2..2, comment));
}

/// Writes an image as a PNG file, under a temporary name that is changed at the end. An existing file is replaced.
///
/// `rgba` contains `width * height` pixels, rows from the top, four bytes each, sRGB encoded.
///
/// # Errors
/// [`RecordError::Io`] if the disk is full, or the folder is missing or not writable.
pub fn write_png(path: &Path, width: u32, height: u32, rgba: &[u8]) -> Result<(), RecordError> {
    let failed = |error| RecordError::io(path, "write the image", error);
    let mut file = Vec::new();
    encode_png(&mut file, width, height, rgba).map_err(|error| failed(std::io::Error::other(error)))?;
    let mut partial = PartialFile::create(path, &open_file).map_err(failed)?;
    partial.write_all(&file).map_err(failed)?;
    partial.commit(true).map_err(failed)
}

fn encode_png(file: &mut Vec<u8>, width: u32, height: u32, rgba: &[u8]) -> Result<(), EncodingError> {
    let mut encoder = Encoder::new(file, width, height);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    mark_png(&mut encoder)?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgba)?;
    writer.finish()
}

/// An image as JPEG in at most `most_bytes`, by the best quality that fits; `None` if none does. Alpha is left out.
///
/// `rgba` contains `width * height` pixels, rows from the top, four bytes each, sRGB encoded.
pub fn jpeg_within(most_bytes: usize, width: u32, height: u32, rgba: &[u8]) -> Option<Vec<u8>> {
    let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    if rgb.len() as u64 != 3 * u64::from(width) * u64::from(height) {
        return None;
    }
    (2..=19).rev().map(|quality| quality * 5).find_map(|quality| {
        let mut file = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut file, quality);
        encoder.write_image(&rgb, width, height, ExtendedColorType::Rgb8).ok()?;
        mark_jpeg(&mut file);
        (file.len() <= most_bytes).then_some(file)
    })
}

/// Width, height and pixels, as [`jpeg_within`] takes them, of a JPEG image of at most `most_side` pixels a side; `None` if it is none.
pub fn read_jpeg(file: &[u8], most_side: u32) -> Option<(u32, u32, Vec<u8>)> {
    let decoder = JpegDecoder::new(std::io::Cursor::new(file)).ok()?;
    let (width, height) = decoder.dimensions();
    if width.max(height) > most_side {
        return None;
    }
    let image = image::DynamicImage::from_decoder(decoder).ok()?;
    Some((width, height, image.into_rgba8().into_raw()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_comes_back_and_a_missing_folder_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("bild ü.png");
        let rgba: Vec<u8> = (0..4 * 6).map(|i| i * 10).collect();
        write_png(&path, 3, 2, &rgba).expect("written");
        let read = image::open(&path).expect("a picture").into_rgba8();
        assert_eq!((read.width(), read.height(), read.into_raw()), (3, 2, rgba.clone()));
        assert!(is_marked(&std::fs::read(&path).expect("the file")));
        assert!(write_png(&path, 3, 3, &rgba).is_err(), "not those pixels");
        let nowhere = folder.path().join("none").join("x.png");
        let error = write_png(&nowhere, 3, 2, &rgba).expect_err("no folder").to_string();
        assert!(error.contains("x.png"), "{error}");
    }

    fn is_marked(file: &[u8]) -> bool {
        file.windows(IMAGE_MARK.len()).any(|window| window == IMAGE_MARK)
    }

    #[test]
    fn a_jpeg_keeps_its_size_and_is_read_again() {
        let (width, height) = (64, 80);
        let noise = |i: u32| (i.wrapping_mul(2_654_435_761) >> 24) as u8;
        let rgba: Vec<u8> = (0..width * height).flat_map(|i| [noise(i), noise(i + 7), 90, 255]).collect();
        let large = jpeg_within(usize::MAX, width, height, &rgba).expect("an image");
        let small = jpeg_within(large.len() / 2, width, height, &rgba).expect("an image");
        assert!(small.len() <= large.len() / 2);
        let (w, h, read) = read_jpeg(&large, 100).expect("an image");
        let error = rgba.iter().zip(&read).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>();
        assert!(is_marked(&large) && is_marked(&small));
        assert!((w, h) == (width, height) && error / (read.len() as f64) < 20.0, "{error}");
        assert_eq!(jpeg_within(100, width, height, &rgba), None, "too small for any quality");
        assert_eq!(jpeg_within(usize::MAX, width, height + 1, &rgba), None, "not those pixels");
        assert_eq!(read_jpeg(&large, 79), None, "too large");
        assert!(read_jpeg(b"no image", 100).is_none() && read_jpeg(&large[..40], 100).is_none());
    }
}
