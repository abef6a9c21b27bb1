//! Files: what is read, and what each refusal says.

use std::fs;
use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, IntegerBounds, Layer,
    LayerAttributes, LineOrder, SpecificChannels, Vec2, WritableImage as _, f16,
};
use glam::{Vec3, vec3};
use image::{DynamicImage, ImageFormat};

use super::super::{EnvironmentError, Panorama, Problem};
use super::{assert_near, exr_of, hdr, noise, panorama};

fn load(name: &str, bytes: &[u8]) -> Result<Panorama, EnvironmentError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    Panorama::load(&path)
}

/// The message of a refusal, which names the file.
fn refusal(name: &str, bytes: &[u8]) -> String {
    let message = load(name, bytes).unwrap_err().to_string();
    assert!(message.contains(name), "{message}");
    message
}

#[track_caller]
fn assert_equal(found: &Panorama, wanted: &Panorama, tolerance: f32) {
    assert_eq!(found.size(), wanted.size());
    for (a, b) in found.surround().sh.into_iter().zip(wanted.surround().sh) {
        assert!((a - b).abs().max_element() < tolerance, "{a} {b}");
    }
    for (&a, &b) in found.thumbnail().texels.iter().zip(&wanted.thumbnail().texels) {
        assert_near(a, b, tolerance);
    }
}

#[test]
fn radiance_files_read_as_the_image_crate_reads_them() {
    // Below 8 pixels the rows are not compressed.
    for (width, height) in [(1, 1), (4, 2), (64, 32), (300, 150)] {
        let mut pixels = noise(width, height);
        // Runs, and a wide range of exponents.
        pixels[..width].fill(vec3(1e4, 1.0, 1e-4));
        let bytes = hdr(width, height, &pixels);
        let decoded = image::load_from_memory_with_format(&bytes, ImageFormat::Hdr).unwrap();
        let DynamicImage::ImageRgb32F(decoded) = decoded else { panic!("not floats") };
        let decoded: Vec<Vec3> = decoded.pixels().map(|pixel| Vec3::from_array(pixel.0)).collect();
        // The extension does not decide.
        let found = load("a.exr", &bytes).unwrap();
        assert_eq!(found, panorama(width, height, &decoded));
    }
}

#[test]
fn radiance_rows_and_columns_may_be_reversed() {
    let pixels = noise(16, 8);
    let bytes = hdr(16, 8, &pixels);
    let reversed = |order: &str| {
        let text = bytes.iter().map(|&b| char::from(b)).collect::<String>().replace("-Y 8 +X 16", order);
        load("a.hdr", &text.chars().map(|c| c as u8).collect::<Vec<u8>>()).unwrap()
    };
    let plain = load("a.hdr", &bytes).unwrap();
    let both = reversed("+Y 8 -X 16");
    let turned: Vec<Vec3> = plain.thumbnail().texels.iter().rev().copied().collect();
    for (&a, &b) in both.thumbnail().texels.iter().zip(&turned) {
        assert_near(a, b, 1e-6);
    }
    assert_ne!(reversed("+Y 8 +X 16"), plain);
    assert_ne!(reversed("-Y 8 -X 16"), plain);
}

#[test]
fn the_oldest_runs_of_radiance_are_read() {
    let mut bytes = b"#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 300\n".to_vec();
    // One pixel of 1, and 299 = 43 + 256 repeats of it.
    bytes.extend([128, 128, 128, 129, 1, 1, 1, 43, 1, 1, 1, 1]);
    let found = load("old.hdr", &bytes).unwrap();
    assert_near(found.surround().mean(), Vec3::ONE, 1e-6);
    // A chain of empty repeats is no reason to count without end.
    bytes.truncate(bytes.len() - 8);
    bytes.extend([1, 1, 1, 0].repeat(12));
    assert!(refusal("old.hdr", &bytes).contains("a run longer than the row"));
}

#[test]
fn exr_files_of_any_encoding_are_read() {
    let pixels = noise(80, 40);
    let wanted = panorama(80, 40, &pixels);
    let tiles = Blocks::Tiles(Vec2(32, 16));
    for (compression, blocks, tolerance) in [
        (Compression::Uncompressed, Blocks::ScanLines, 1e-6),
        (Compression::RLE, Blocks::ScanLines, 1e-6),
        (Compression::ZIP1, Blocks::ScanLines, 1e-6),
        (Compression::ZIP16, tiles, 1e-6),
        (Compression::PIZ, Blocks::ScanLines, 1e-6),
        (Compression::PXR24, tiles, 1e-4),
    ] {
        let found = load("a.exr", &exr_of(80, 40, &pixels, compression, blocks)).unwrap();
        assert_equal(&found, &wanted, tolerance);
        assert!(found.notes().messages().is_empty());
    }
}

/// A layer of 8 x 4 pixels at `position`, with channels of these names and values.
fn layer(position: Vec2<i32>, channels: &[(&str, FlatSamples)], window: IntegerBounds) -> Vec<u8> {
    let list = channels.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone())).collect();
    let attributes = LayerAttributes::named("layer").with_position(position);
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Decreasing,
    };
    let layer = Layer::new((8, 4), attributes, encoding, AnyChannels::sort(list));
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = window;
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn whole() -> IntegerBounds {
    IntegerBounds::from_dimensions(Vec2(8, 4))
}

#[test]
fn exr_channels_of_other_types_and_names_may_stand_between() {
    let half = FlatSamples::F16(vec![f16::from_f32(0.5); 32]);
    let float = FlatSamples::F32(vec![2.0; 32]);
    let whole_number = FlatSamples::U32(vec![3; 32]);
    let alpha = FlatSamples::F16(vec![f16::from_f32(9.0); 32]);
    let channels = [("A", alpha.clone()), ("B", whole_number), ("G", half), ("N.X", alpha), ("R", float)];
    let found = load("a.exr", &layer(Vec2(0, 0), &channels, whole())).unwrap();
    assert_near(found.surround().mean(), vec3(2.0, 0.5, 3.0), 1e-6);
}

#[test]
fn exr_data_is_placed_in_its_display_window() {
    let one = FlatSamples::F32(vec![1.0; 32]);
    let channels = [("R", one.clone()), ("G", one.clone()), ("B", one)];
    let window = IntegerBounds::new(Vec2(-2, -1), Vec2(16, 8));
    let found = load("a.exr", &layer(Vec2(6, 3), &channels, window)).unwrap();
    // Eight columns right, four rows down: the lower right quarter.
    let pixels: Vec<Vec3> =
        (0..128).map(|at| if at % 16 >= 8 && at / 16 >= 4 { Vec3::ONE } else { Vec3::ZERO }).collect();
    assert_equal(&found, &panorama(16, 8, &pixels), 1e-6);
    assert_eq!(found.notes().missing, 128 - 32);
    // Data to the upper left of the window: what is outside is ignored.
    let found = load("a.exr", &layer(Vec2(-6, -3), &channels, window)).unwrap();
    let pixels: Vec<Vec3> =
        (0..128).map(|at| if at % 16 < 4 && at / 16 < 2 { Vec3::ONE } else { Vec3::ZERO }).collect();
    assert_equal(&found, &panorama(16, 8, &pixels), 1e-6);
}

#[test]
fn exr_infinities_are_counted() {
    let infinite = FlatSamples::F16(vec![f16::INFINITY; 32]);
    let not_a_number = FlatSamples::F32(vec![f32::NAN; 32]);
    let channels = [("R", infinite), ("G", not_a_number.clone()), ("B", not_a_number)];
    let found = load("a.exr", &layer(Vec2(0, 0), &channels, whole())).unwrap();
    assert_eq!(found.notes().not_finite, 32);
    assert_near(found.surround().mean(), vec3(65_504.0, 0.0, 0.0), 1e-5);
}

#[test]
fn exr_without_colours_is_refused_by_its_channels() {
    let one = FlatSamples::F32(vec![1.0; 32]);
    let message = refusal("depth.exr", &layer(Vec2(0, 0), &[("Y", one.clone()), ("Z", one)], whole()));
    assert!(message.contains("has the channels Y, Z; must"), "{message}");
}

#[test]
fn deep_exr_is_refused() {
    let mut bytes = exr_of(8, 4, &noise(8, 4), Compression::ZIP16, Blocks::ScanLines);
    bytes[5] |= 0b1000;
    assert!(refusal("deep.exr", &bytes).contains("has deep data; must be a flat layer"));
}

#[test]
fn large_pictures_are_refused_by_their_header() {
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 50000 +X 100000\n";
    let message = refusal("large.hdr", header);
    assert!(message.contains("is 100000 x 50000 pixels; must be at most 16384 x 8192"), "{message}");
    let wide = SpecificChannels::rgb(|_: Vec2<usize>| (1.0_f32, 1.0_f32, 1.0_f32));
    let mut bytes = Cursor::new(Vec::new());
    let encoding = Encoding::SMALL_FAST_LOSSLESS;
    let image = Image::from_encoded_channels((100_000, 1), encoding, wide);
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    assert!(refusal("large.exr", &bytes.into_inner()).contains("is 100000 x 1 pixels; must be at most"));
}

#[test]
fn empty_pictures_are_refused() {
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n";
    assert!(refusal("empty.hdr", header).contains("is 0 x 0 pixels; must be at least 1 x 1"));
    assert!(refusal("empty.hdr", b"").contains("contains nothing; must be a Radiance (.hdr) or OpenEXR"));
}

#[test]
fn pictures_cut_short_say_how_far_they_go() {
    let bytes = hdr(64, 32, &noise(64, 32));
    let message = refusal("short.hdr", &bytes[..bytes.len() / 2]);
    assert!(message.contains("is cut short: found 1"), "{message}");
    assert!(message.contains("rows; must be 32 rows"), "{message}");
    assert!(refusal("short.hdr", &bytes[..20]).contains("is cut short: found a part of the header"));
    let bytes = exr_of(64, 32, &noise(64, 32), Compression::ZIP16, Blocks::ScanLines);
    let message = refusal("short.exr", &bytes[..bytes.len() / 2]);
    assert!(message.contains("is cut short: found the file's end in block"), "{message}");
    assert!(refusal("short.exr", &bytes[..60]).contains("is cut short"));
}

#[test]
fn what_is_no_picture_is_named() {
    assert!(refusal("a.hdr", b"a letter to a friend").contains("contains the text \"a letter to a fr\""));
    assert!(refusal("a.exr", b"\x89PNG\r\n\x1a\n").contains("contains a PNG picture"));
    assert!(refusal("a.exr", &[0, 1, 2, 250]).contains("contains the bytes [00, 01, 02, fa]"));
    let xyz = b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\0\0\0\0";
    assert!(refusal("a.hdr", xyz).contains("has colours \"32-bit_rle_xyze\"; must be 32-bit_rle_rgbe"));
    assert!(refusal("a.hdr", b"#?RADIANCE\n\n+X 2 +Y 1\n").contains("columns one by one"));
    assert!(refusal("a.hdr", b"#?RADIANCE\n\nY two\n").contains("is damaged: found \"Y two\""));
    let endless = [b"#?RADIANCE\n".to_vec(), vec![b'a'; 1 << 20]].concat();
    assert!(refusal("a.hdr", &endless).contains("no size in 65536 bytes"));
}

#[test]
fn folders_and_missing_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = Panorama::load(folder.path()).unwrap_err();
    assert!(matches!(error.problem, Problem::NotAFile("a folder")), "{error}");
    let error = Panorama::load(&folder.path().join("missing.hdr")).unwrap_err();
    assert!(matches!(error.problem, Problem::Io(_)), "{error}");
    assert!(error.to_string().contains("missing.hdr: cannot be read"), "{error}");
}

#[test]
fn a_dwa_block_that_announces_too_much_is_refused() {
    let bytes = exr_of(32, 16, &noise(32, 16), Compression::DWAA(None), Blocks::ScanLines);
    assert_eq!(load("dwa.exr", &bytes).unwrap().size(), [32, 16]);
    // The one block: its row, the number of its bytes, and those up to the end of the file.
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let block = (0..bytes.len() - 8).find(|&at| number(at) == 0 && number(at + 4) == bytes.len() - at - 8);
    let mut announcing = bytes.clone();
    // The ninth of its numbers, the count of coefficients: 2^40 of two bytes.
    let at = block.unwrap() + 8 + 8 * 8;
    announcing[at..at + 8].copy_from_slice(&(1_u64 << 40).to_le_bytes());
    let message = refusal("dwa.exr", &announcing);
    assert!(message.contains("sizes in a DWA block far above its pixels"), "{message}");
}
