//! Pixels averaged onto a small picture.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3, vec3};

use super::super::picture::{LARGEST_RADIANCE, Reduced, Reducer};
use super::super::{Panorama, Problem};
use super::{noise, panorama};

fn reduced(width: usize, height: usize, pixels: &[Vec3]) -> Reduced {
    let mut reducer = Reducer::new(width as u64, height as u64).unwrap();
    for (y, row) in pixels.chunks_exact(width).enumerate() {
        reducer.add(0, y, row.iter().map(Vec3::to_array));
    }
    reducer.finish()
}

/// The light of the whole sphere: radiance times solid angle.
fn energy(width: usize, height: usize, pixels: &[DVec3]) -> DVec3 {
    let sine = |row: usize| (PI * row as f64 / height as f64).cos();
    let rows = pixels.chunks_exact(width).enumerate();
    let of_row = |(at, row): (usize, &[DVec3])| row.iter().sum::<DVec3>() * (sine(at) - sine(at + 1));
    rows.map(of_row).sum::<DVec3>() * TAU / width as f64
}

#[test]
fn the_light_of_the_sphere_is_kept() {
    for (width, height) in [(512, 256), (513, 257), (1000, 500), (1501, 333), (300, 700), (5, 3)] {
        let mut pixels = noise(width, height);
        // Bright poles, so that a mean of rows without their areas differs.
        pixels[..width].fill(Vec3::splat(200.0));
        let wide: Vec<DVec3> = pixels.iter().map(|p| p.as_dvec3()).collect();
        let small = reduced(width, height, &pixels);
        let (before, after) =
            (energy(width, height, &wide), energy(small.width, small.height, &small.texels));
        assert!((before - after).abs().max_element() < 1e-9 * before.max_element(), "{width} x {height}");
        let plain = wide.iter().sum::<DVec3>() * (2.0 * TAU / wide.len() as f64);
        assert!((before - plain).abs().max_element() > 0.05 * before.max_element(), "areas are not seen");
    }
}

#[test]
fn the_small_picture_is_bounded_and_parts_may_come_in_any_order() {
    let (width, height) = (700, 400);
    let pixels = noise(width, height);
    let whole = reduced(width, height, &pixels);
    assert_eq!((whole.width, whole.height), (512, 256));
    let mut reducer = Reducer::new(width as u64, height as u64).unwrap();
    for y in (0..height).rev() {
        for (from, to) in [(350, 700), (0, 350)] {
            let row = &pixels[y * width + from..y * width + to];
            reducer.add(from, y, row.iter().map(Vec3::to_array));
        }
    }
    let parts = reducer.finish();
    let worst = whole.texels.iter().zip(&parts.texels).map(|(a, b)| (*a - *b).abs().max_element());
    assert!(worst.fold(0.0, f64::max) < 1e-12);
    assert_eq!(reducer.notes().missing, 0);
}

#[test]
fn values_that_no_light_has_are_replaced_and_counted() {
    let mut pixels = vec![Vec3::ONE; 8 * 4];
    pixels[0] = vec3(f32::NAN, 1.0, 1.0);
    pixels[1] = vec3(f32::INFINITY, 1.0, 1.0);
    pixels[2] = vec3(f32::NEG_INFINITY, 1.0, 1.0);
    pixels[3] = vec3(1.0, -3.0, 1.0);
    pixels[4] = vec3(1.0, f32::MAX, f32::MAX);
    let texels = reduced(8, 4, &pixels).texels;
    let near = |at: usize, wanted: [f64; 3]| {
        let wanted = DVec3::from_array(wanted);
        assert!((texels[at] - wanted).abs().max_element() <= 1e-12 * wanted.max_element(), "{at}");
    };
    near(0, [0.0, 1.0, 1.0]);
    near(1, [65_504.0, 1.0, 1.0]);
    near(2, [0.0, 1.0, 1.0]);
    near(3, [1.0, 0.0, 1.0]);
    near(4, [1.0, f64::from(LARGEST_RADIANCE), f64::from(LARGEST_RADIANCE)]);
    let notes = panorama(8, 4, &pixels).notes();
    assert_eq!((notes.not_finite, notes.negative, notes.too_bright), (3, 1, 1));
    assert!(!notes.stretched);
    assert_eq!(notes.messages().len(), 3);
    assert_eq!(notes.messages()[1], "1 pixel negative: set to 0");
    assert!(panorama(8, 4, &[Vec3::ONE; 32]).notes().messages().is_empty());
}

#[test]
fn another_shape_is_stretched_with_a_note() {
    let square = panorama(32, 32, &[Vec3::ONE; 32 * 32]);
    assert!(square.notes().stretched);
    assert_eq!(square.notes().messages().len(), 1);
}

#[test]
fn impossible_sizes_are_refused() {
    assert!(matches!(Panorama::from_pixels(0, 4, &[]), Err(Problem::Empty { .. })));
    assert!(matches!(Panorama::from_pixels(100_000, 1, &[]), Err(Problem::TooLarge { .. })));
    assert!(matches!(Panorama::from_pixels(2, 8193, &[]), Err(Problem::TooLarge { .. })));
    assert!(matches!(Panorama::from_pixels(2, 2, &[Vec3::ONE; 3]), Err(Problem::CutShort { .. })));
}

#[test]
fn the_thumbnail_is_small_and_encoded() {
    let pixels: Vec<Vec3> = (0..256 * 128).map(|at| Vec3::splat(f32::from(at < 256 * 64))).collect();
    let picture = panorama(256, 128, &pixels);
    let thumbnail = picture.thumbnail();
    assert_eq!((thumbnail.width, thumbnail.height, thumbnail.texels.len()), (64, 32, 64 * 32));
    let bytes = thumbnail.rgba8(0.5);
    assert_eq!(bytes.len(), 4 * 64 * 32);
    // sRGB of one half is 188.
    assert_eq!((&bytes[..4], &bytes[bytes.len() - 4..]), (&[188, 188, 188, 255][..], &[0, 0, 0, 255][..]));
    assert_eq!(panorama(3, 2, &[Vec3::ONE; 6]).thumbnail().texels.len(), 6);
}
