//! Writes a single image as a PNG file.

use std::io::Write;
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::RecordError;
use crate::partial::{PartialFile, open_file};

/// Writes an image as a PNG file, under a temporary name that is changed at the end. An existing file is replaced.
///
/// `rgba` contains `width * height` pixels, rows from the top, four bytes each, sRGB encoded.
///
/// # Errors
/// [`RecordError::Io`] if the disk is full, or the folder is missing or not writable.
pub fn write_png(path: &Path, width: u32, height: u32, rgba: &[u8]) -> Result<(), RecordError> {
    let failed = |error| RecordError::io(path, "write the image", error);
    let mut file = Vec::new();
    PngEncoder::new(&mut file)
        .write_image(rgba, width, height, ExtendedColorType::Rgba8)
        .map_err(|error| failed(std::io::Error::other(error)))?;
    let mut partial = PartialFile::create(path, &open_file).map_err(failed)?;
    partial.write_all(&file).map_err(failed)?;
    partial.commit(true).map_err(failed)
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
        let nowhere = folder.path().join("none").join("x.png");
        let error = write_png(&nowhere, 3, 2, &rgba).expect_err("no folder").to_string();
        assert!(error.contains("x.png"), "{error}");
    }
}
