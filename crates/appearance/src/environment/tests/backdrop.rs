//! Pictures behind the figure, and files that are none.

use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb};

use crate::environment::{BackdropPicture, BackdropPixels, Panorama};

fn bytes(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    image.write_to(&mut out, format).expect("a picture");
    out.into_inner()
}

fn load(folder: &Path, name: &str, content: &[u8]) -> Result<BackdropPicture, String> {
    let path = folder.join(name);
    std::fs::write(&path, content).expect("a file");
    BackdropPicture::load(&path).map_err(|error| error.to_string())
}

fn first(picture: &BackdropPicture) -> [u8; 4] {
    match picture.pixels() {
        BackdropPixels::Display(pixels) => pixels[0],
        BackdropPixels::Light(_) => panic!("a picture of light"),
    }
}

#[test]
fn photographs_of_any_depth_are_read_whatever_their_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let colour = DynamicImage::from(ImageBuffer::from_pixel(6, 4, Rgb([200_u8, 100, 50])));
    let grey = DynamicImage::from(ImageBuffer::from_pixel(5, 3, Luma([0x8000_u16])));
    let png = load(folder.path(), "a.jpg", &bytes(&colour, ImageFormat::Png)).expect("a picture");
    assert_eq!((png.size(), first(&png)), ([6, 4], [200, 100, 50, 255]));
    let deep = load(folder.path(), "b.png", &bytes(&grey, ImageFormat::Png)).expect("a picture");
    assert_eq!((deep.size(), first(&deep)), ([5, 3], [128, 128, 128, 255]));
    let jpeg = load(folder.path(), "c", &bytes(&colour, ImageFormat::Jpeg)).expect("a picture");
    assert!(
        first(&jpeg).iter().zip([200, 100, 50, 255]).all(|(a, b)| a.abs_diff(b) <= 6),
        "{:?}",
        first(&jpeg)
    );
}

#[test]
fn a_large_picture_is_averaged_to_what_is_used() {
    let folder = tempfile::tempdir().expect("a folder");
    let wide = DynamicImage::from(ImageBuffer::from_pixel(9000, 8, Luma([77_u8])));
    let picture = load(folder.path(), "wide.png", &bytes(&wide, ImageFormat::Png)).expect("a picture");
    assert!(picture.size()[0] <= 4096 && first(&picture)[0] == 77, "{:?}", picture.size());
}

#[test]
fn a_picture_of_light_keeps_its_light() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("light.exr");
    exr::prelude::write_rgb_file(&path, 40, 16, |x, _| (x as f32, 2.5, 0.25)).expect("a picture");
    let picture = BackdropPicture::load(&path).expect("a picture");
    let BackdropPixels::Light(pixels) = picture.pixels() else { panic!("a photograph") };
    assert_eq!(picture.size(), [40, 16]);
    for x in [0, 7, 39] {
        let truth = [x as f32, 2.5, 0.25];
        assert!(pixels[3 * 40 + x].iter().zip(truth).all(|(a, b)| (a - b).abs() < 1e-3), "{:?}", pixels[x]);
    }
    assert!(Panorama::load(&path).is_ok(), "the same file gives light too");
}

/// The start of a PNG file of some size, without its pixels.
fn header(width: u32, height: u32) -> Vec<u8> {
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = b"IHDR".to_vec();
    chunk.extend(width.to_be_bytes());
    chunk.extend(height.to_be_bytes());
    chunk.extend([8, 2, 0, 0, 0]);
    file.extend(13_u32.to_be_bytes());
    file.extend(&chunk);
    file.extend(crc(&chunk).to_be_bytes());
    file.extend(16_u32.to_be_bytes());
    file.extend(b"IDAT");
    file.extend([0; 16]);
    file
}

fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 },
        )
    })
}

#[test]
fn what_is_no_picture_is_named_in_one_sentence() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole =
        bytes(&DynamicImage::from(ImageBuffer::from_pixel(64, 64, Rgb([9_u8, 8, 7]))), ImageFormat::Png);
    let cases = [
        ("huge.png", header(60_000, 60_000), "60000 x 60000"),
        ("none.png", header(0, 5), "damaged"),
        ("cut.png", whole[..whole.len() / 2].to_vec(), "damaged"),
        ("text.png", b"no picture at all".to_vec(), "no picture"),
        ("empty.jpg", Vec::new(), "nothing"),
        ("gif.png", b"GIF89a\x01\x00\x01\x00".to_vec(), "must be a PNG, JPEG"),
        ("cut.jpg", b"\xff\xd8\xff\xe0\x00\x10JFIF".to_vec(), "damaged"),
        ("cut.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 9\n".to_vec(), "cut short"),
    ];
    for (name, content, found) in cases {
        let error = load(folder.path(), name, &content).expect_err(name);
        assert!(
            error.contains(name) && error.contains(found) && error.lines().count() == 1,
            "{name}: {error}"
        );
    }
    let gone = BackdropPicture::load(&folder.path().join("gone.png")).expect_err("no file").to_string();
    assert!(gone.contains("gone.png") && gone.contains("cannot be read"), "{gone}");
    assert!(BackdropPicture::load(folder.path()).expect_err("a folder").to_string().contains("a folder"));
}

#[test]
fn damaged_bytes_never_panic() {
    let image = ImageBuffer::from_fn(40, 30, |x, y| Rgb([x as u8 * 6, y as u8 * 8, (x * y) as u8]));
    for format in [ImageFormat::Png, ImageFormat::Jpeg] {
        let whole = bytes(&DynamicImage::from(image.clone()), format);
        let mut seed = 12345_u32;
        for _ in 0..150 {
            let mut broken = whole.clone();
            for _ in 0..3 {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let at = seed as usize % broken.len();
                broken[at] = (seed >> 24) as u8;
            }
            let _ = BackdropPicture::decode(&broken, format);
        }
    }
}
