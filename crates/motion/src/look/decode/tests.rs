use std::borrow::Cow;
use std::io::Cursor;

use image::{DynamicImage, ImageFormat, Luma, Rgba, RgbaImage};

use super::{Encoded, decode, half};

fn encoded(name: &str, image: &DynamicImage, format: ImageFormat) -> Encoded<'static> {
    let mut bytes = Vec::new();
    image.write_to(&mut Cursor::new(&mut bytes), format).unwrap();
    raw(name, bytes)
}

fn raw(name: &str, bytes: Vec<u8>) -> Encoded<'static> {
    Encoded { name: name.to_owned(), bytes: Ok(Cow::Owned(bytes)) }
}

fn checks() -> DynamicImage {
    RgbaImage::from_fn(3, 2, |x, y| Rgba([80 * x as u8, 200 * y as u8, 7, 255])).into()
}

/// The header of a PNG of any size, without pixels.
fn header(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    checks().write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).unwrap();
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let sum = crc(&bytes[12..29]).to_be_bytes();
    bytes[29..33].copy_from_slice(&sum);
    bytes
}

/// CRC-32 of PNG.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |sum, &byte| {
        (0..8).fold(
            sum ^ u32::from(byte),
            |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 },
        )
    })
}

#[test]
fn sixteen_bits_and_grey_become_eight_bits_of_four_channels() {
    let grey =
        DynamicImage::from(image::ImageBuffer::from_fn(2, 1, |x, _| Luma([[0_u16, 0x8000][x as usize]])));
    let images = [
        ("rgba", checks(), ImageFormat::Png),
        ("grey", grey, ImageFormat::Png),
        ("jpeg", checks().to_rgb8().into(), ImageFormat::Jpeg),
    ];
    let mut notes = Vec::new();
    let all: Vec<_> = images.iter().map(|(name, image, format)| encoded(name, image, *format)).collect();
    let (images, places) = decode(&all, &mut notes);
    assert_eq!((places, notes), (vec![Some(0), Some(1), Some(2)], Vec::new()));
    assert_eq!((images[0].size, &images[0].pixels[..]), ([3, 2], checks().as_bytes()));
    assert_eq!((images[1].size, &images[1].pixels[..]), ([2, 1], &[0, 0, 0, 255, 128, 128, 128, 255][..]));
    assert_eq!(images[2].size, [3, 2]);
}

#[test]
fn each_lost_image_is_told_and_the_others_keep_their_places() {
    let png = encoded("a", &checks(), ImageFormat::Png);
    let cut = png.bytes.as_ref().unwrap()[..40].to_vec();
    let missing = Encoded { name: "missing".into(), bytes: Err("is not there".into()) };
    let (mut notes, all) = (
        Vec::new(),
        vec![
            raw("cut", cut),
            missing,
            raw("empty", Vec::new()),
            raw("ktx", b"\xabKTX 20\xbb\r\n\x1a\n".to_vec()),
            raw("wide", header(60_000, 60_000)),
            raw("none", header(0, 5)),
            png,
        ],
    );
    let (images, places) = decode(&all, &mut notes);
    assert_eq!(images.len(), 1);
    assert_eq!(places, [None, None, None, None, None, None, Some(0)]);
    assert_eq!(notes.len(), 6, "{notes:#?}");
    for (note, words) in
        notes.iter().zip(["`cut`", "is not there", "is empty", "KTX2", "60000 by 60000", "`none`"])
    {
        assert!(note.contains(words), "{note}: {words}");
    }
}

#[test]
fn an_image_cut_anywhere_is_told() {
    let noise: DynamicImage = RgbaImage::from_fn(64, 64, |x, y| {
        Rgba([(x * y * 7) as u8, ((x * 31) ^ y) as u8, (y * 3) as u8, 255])
    })
    .into();
    for (format, image) in [
        (ImageFormat::Png, noise.clone()),
        (ImageFormat::Jpeg, noise.to_rgb8().into()),
        (ImageFormat::WebP, noise.clone()),
    ] {
        let whole = encoded("a", &image, format);
        let bytes = whole.bytes.clone().unwrap();
        let mut notes = Vec::new();
        let (sound, _) = decode(&[whole], &mut notes);
        assert!(notes.is_empty(), "{notes:?}");
        let mut kept = 0;
        for length in (0..20).map(|k| bytes.len() * k / 20).chain([bytes.len() - 3, bytes.len() - 1]) {
            let mut notes = Vec::new();
            let (images, _) = decode(&[raw("a", bytes[..length].to_vec())], &mut notes);
            let is_same = images.first().is_some_and(|image| image.pixels == sound[0].pixels);
            kept += images.len();
            assert!(
                is_same || notes.len() == 1 && notes[0].contains("`a`"),
                "{format:?} {length}: {notes:?}"
            );
            assert!(format != ImageFormat::Jpeg || notes.len() == 1, "{length}: {notes:?}");
        }
        // What is left of a JPEG is seen.
        assert!(format != ImageFormat::Jpeg || kept > 10, "{kept}");
    }
}

#[test]
fn a_header_of_many_pixels_allocates_nothing() {
    // Within the sides that are read, with the bytes of six pixels.
    let all: Vec<_> = (0..20).map(|k| raw(&k.to_string(), header(8192, 8000))).collect();
    let mut notes = Vec::new();
    let (images, _) = decode(&all, &mut notes);
    assert!(images.is_empty());
    assert_eq!(notes.len(), 7, "{notes:#?}");
}

#[test]
fn half_an_image_has_the_mean_of_its_pixels() {
    let pixels =
        [[0, 100, 8, 255], [2, 100, 8, 255], [9; 4], [4, 200, 8, 255], [6, 200, 8, 255], [9; 4]].concat();
    assert_eq!(half([3, 2], &pixels), ([1, 1], vec![3, 150, 8, 255]));
    let column = [[10; 4], [20; 4]].concat();
    assert_eq!(half([1, 2], &column), ([1, 1], vec![15; 4]), "a single column stays");
}
