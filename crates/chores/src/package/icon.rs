//! The icon of the program for Windows: all sizes of the icon in one file, which `app/build.rs` puts into the program.

use anyhow::{Context as _, ensure};
use lovelock_xtask::tool;
use std::fs;
use std::path::PathBuf;

/// Sizes in pixels that are stored as bitmaps, because not all programs read small icons as PNG, and those that are stored as PNG.
const BITMAPS: [u32; 5] = [16, 24, 32, 48, 64];
const PNGS: [u32; 2] = [128, 256];

/// Length of the header of the file, of an entry and of the header of a bitmap, bytes.
const HEADER: usize = 6;
const ENTRY: usize = 16;
const BITMAP_HEADER: u32 = 40;

/// Writes the icon into the tree.
pub(super) fn write() -> anyhow::Result<()> {
    let (path, bytes) = (path(), bytes()?);
    fs::write(&path, &bytes).with_context(|| path.display().to_string())?;
    println!("{}: {} bytes", path.display(), bytes.len());
    Ok(())
}

fn path() -> PathBuf {
    tool::root().join("packaging").join("windows").join("lovelock.ico")
}

/// The image of a size.
fn image_of(size: u32) -> PathBuf {
    tool::root().join("packaging").join("icons").join(format!("{size}x{size}")).join("lovelock.png")
}

/// The file: a header, an entry per image, and the images.
fn bytes() -> anyhow::Result<Vec<u8>> {
    let mut images = Vec::new();
    for size in BITMAPS {
        images.push((size, bitmap(size)?));
    }
    for size in PNGS {
        let path = image_of(size);
        images.push((size, fs::read(&path).with_context(|| path.display().to_string())?));
    }
    let mut file = Vec::new();
    // Kind 1 is an icon.
    for word in [0, 1, images.len() as u16] {
        file.extend(word.to_le_bytes());
    }
    let mut at = HEADER + ENTRY * images.len();
    for (size, image) in &images {
        // The size 256 is written as 0.
        file.extend([*size as u8, *size as u8, 0, 0]);
        // One plane of 32 bits per pixel.
        for word in [1_u16, 32] {
            file.extend(word.to_le_bytes());
        }
        for number in [image.len() as u32, at as u32] {
            file.extend(number.to_le_bytes());
        }
        at += image.len();
    }
    file.extend(images.into_iter().flat_map(|(_, image)| image));
    Ok(file)
}

/// An image as a bitmap: blue, green, red and alpha from the last row up, and a mask of the pixels where nothing is.
fn bitmap(size: u32) -> anyhow::Result<Vec<u8>> {
    let path = image_of(size);
    let image = image::open(&path).with_context(|| path.display().to_string())?.into_rgba8();
    let found = image.dimensions();
    ensure!(
        found == (size, size),
        "{}: found {}x{} pixels; must be {size}x{size}",
        path.display(),
        found.0,
        found.1
    );
    let mut bytes = Vec::new();
    // The height is that of the colours and the mask.
    for number in [BITMAP_HEADER, size, 2 * size] {
        bytes.extend(number.to_le_bytes());
    }
    for word in [1_u16, 32] {
        bytes.extend(word.to_le_bytes());
    }
    // Not compressed; what follows may be 0.
    bytes.resize(BITMAP_HEADER as usize, 0);
    for y in (0..size).rev() {
        for x in 0..size {
            let [red, green, blue, alpha] = image.get_pixel(x, y).0;
            bytes.extend([blue, green, red, alpha]);
        }
    }
    for y in (0..size).rev() {
        // Rows of the mask are whole words of 32 bits.
        let mut row = vec![0_u8; size.div_ceil(32) as usize * 4];
        for x in (0..size).filter(|&x| image.get_pixel(x, y).0[3] == 0) {
            row[x as usize / 8] |= 0x80 >> (x % 8);
        }
        bytes.extend(row);
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::{bytes, path};

    #[test]
    fn the_icon_in_the_tree_is_made_of_the_images_in_the_tree() {
        let made = bytes().expect("the images");
        assert!(made.len() < 100 << 10, "{} bytes", made.len());
        let found = std::fs::read(path()).expect("packaging/windows/lovelock.ico");
        assert!(found == made, "the icon is old: `cargo xtask package --icon` writes it");
    }
}
