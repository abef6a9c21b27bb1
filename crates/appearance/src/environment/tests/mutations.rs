//! Damaged files: an answer or an error, and always a finite one.

use std::io::Cursor;

use exr::prelude::{Blocks, Compression, Vec2};
use glam::Vec3;

use super::super::Panorama;
use super::super::picture;
use super::{Numbers, exr_of, hdr, noise};

/// Damaged copies per file.
const COPIES: usize = 100;

/// Reads `bytes`; whether they are a picture.
fn survives(bytes: Vec<u8>) -> bool {
    let Ok(reducer) = picture::read(Cursor::new(bytes)) else { return false };
    let found = Panorama::new(&reducer);
    let finite =
        |values: &[Vec3]| values.iter().all(|value| value.is_finite() && value.length_squared().is_finite());
    assert!(finite(&found.surround().sh) && finite(&found.axis_radiance(1.0)));
    assert!(finite(&found.thumbnail().texels));
    assert!(
        found.strongest().is_none_or(|light| light.direction.is_finite() && light.irradiance.is_finite())
    );
    true
}

fn damaged(bytes: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    // Half of the damage hits the header, which is short and decides the most.
    let reach = if numbers.below(2) == 0 { bytes.len().min(400) } else { bytes.len() };
    for _ in 0..=numbers.below(4) {
        let at = numbers.below(reach);
        match numbers.below(4) {
            0 => bytes[at] ^= 1 << numbers.below(8),
            1 => bytes[at] = numbers.bits() as u8,
            2 => bytes[at] = 0xff,
            _ => {
                let end = (at + 4).min(bytes.len());
                bytes[at..end].fill([0, 0x7f, 0x80, 0xff][numbers.below(4)]);
            }
        }
    }
    if numbers.below(4) == 0 {
        bytes.truncate(numbers.below(bytes.len()));
    }
    bytes
}

#[test]
fn damaged_files_neither_panic_nor_yield_light_that_is_not_finite() {
    let small = noise(32, 16);
    let tiles = Blocks::Tiles(Vec2(8, 8));
    let mut files = vec![hdr(32, 16, &small), hdr(4, 2, &small[..8])];
    let encodings = [
        (Compression::Uncompressed, Blocks::ScanLines),
        (Compression::RLE, Blocks::ScanLines),
        (Compression::ZIP1, tiles),
        (Compression::ZIP16, Blocks::ScanLines),
        (Compression::PIZ, Blocks::ScanLines),
        (Compression::PXR24, tiles),
        (Compression::B44, Blocks::ScanLines),
        (Compression::DWAA(None), Blocks::ScanLines),
    ];
    files.extend(encodings.map(|(compression, blocks)| exr_of(32, 16, &small, compression, blocks)));

    let mut numbers = Numbers(3);
    let (mut read, mut refused) = (0, 0);
    for file in files {
        assert!(survives(file.clone()), "the file itself is in order");
        for _ in 0..COPIES {
            if survives(damaged(&file, &mut numbers)) { read += 1 } else { refused += 1 }
        }
    }
    // Damage is met, and not all of it is refused by the first bytes.
    assert!(read > 50 && refused > 50, "{read} read, {refused} refused");
}
