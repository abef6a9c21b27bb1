//! Light on surfaces.

use std::f32::consts::{PI, TAU};

use glam::{Vec3, vec3};

use super::super::picture::Reducer;
use super::super::project::project;
use super::super::{Environment, Surround};
use super::{ROUNDING, assert_near, noise, normals, one_pixel, panorama, shifted};

const RADIANCE: Vec3 = vec3(0.5, 1.0, 2.0);

/// The projection of a picture, before windowing.
fn projected(width: usize, height: usize, pixels: &[Vec3]) -> Surround {
    let mut reducer = Reducer::new(width as u64, height as u64).unwrap();
    for (y, row) in pixels.chunks_exact(width).enumerate() {
        reducer.add(0, y, row.iter().map(Vec3::to_array));
    }
    project(&reducer.finish())
}

#[test]
fn uniform_light_leaves_a_white_surface_as_it_arrives() {
    for (width, height) in [(1, 1), (2, 1), (7, 5), (64, 32), (700, 350)] {
        let surround = panorama(width, height, &vec![RADIANCE; width * height]).surround();
        for normal in normals() {
            assert_near(surround.polynomial(normal), RADIANCE, ROUNDING);
        }
        assert_near(surround.mean(), RADIANCE, ROUNDING);
    }
}

#[test]
fn sky_above_ground_is_the_mix_by_height() {
    let (sky, ground) = (vec3(1.0, 2.0, 4.0), vec3(0.3, 0.2, 0.1));
    let analytic = Environment::SkyAndGround { sky, ground }.surround(0.7);
    let pixels: Vec<Vec3> = (0..64 * 32).map(|at| if at < 64 * 16 { sky } else { ground }).collect();
    let pictured = panorama(64, 32, &pixels).surround();
    for normal in normals() {
        let mix = ground.lerp(sky, 0.5 + 0.5 * normal.y);
        assert_near(analytic.polynomial(normal), mix, ROUNDING);
        assert_near(pictured.polynomial(normal), mix, ROUNDING);
    }
    // Upside down, another light: the comparison sees the sign of the height.
    let below = analytic.polynomial(Vec3::NEG_Y);
    assert!((below - sky).abs().max_element() > 0.5);
}

#[test]
fn one_pixel_gives_three_orders_of_the_clamped_cosine() {
    let size = [512, 256];
    for at in [[0, 128], [100, 40], [255, 200], [300, 12]] {
        let (pixels, direction, solid) = one_pixel(size, at, 1000.0 * RADIANCE);
        let surround = projected(size[0], size[1], &pixels);
        let mean = 1000.0 * RADIANCE * solid / (4.0 * PI);
        for normal in normals() {
            let cos = normal.dot(direction);
            // Orders 0, 1, 2 of the clamped cosine over pi, times 2 l + 1: 1, 2, 5/4.
            let orders = 1.0 + 2.0 * cos + 1.25 * (1.5 * cos * cos - 0.5);
            let error = (surround.polynomial(normal) - mean * orders).abs().max_element();
            // The extent of the pixel is 0.7 degrees.
            assert!(error <= 1e-3 * mean.max_element(), "{at:?} {normal}: {error}");
        }
    }
}

#[test]
fn a_turn_is_a_shift_by_columns() {
    let (width, height) = (64, 32);
    let mut pixels = noise(width, height);
    // A lamp, so there is a difference to see.
    pixels[10 * width + 20] = vec3(90.0, 60.0, 30.0);
    let surround = panorama(width, height, &pixels).surround();
    for columns in [0, 1, 13, 32, 63] {
        let turn = TAU * columns as f32 / width as f32;
        let wanted = panorama(width, height, &shifted(width, &pixels, columns)).surround();
        for normal in normals() {
            let turned = surround.turned(turn);
            assert_near(turned.polynomial(normal), wanted.polynomial(normal), 5e-5);
        }
    }
    let wrong = surround.turned(-TAU * 13.0 / 64.0);
    let wanted = panorama(width, height, &shifted(width, &pixels, 13)).surround();
    assert!((wrong.sh[2] - wanted.sh[2]).abs().max_element() > 1e-3, "the sense of the turn is not seen");
}

#[test]
fn a_positive_turn_takes_z_to_x() {
    // The centre of the picture looks along +Z, a quarter of its width along +X.
    let (pixels, direction, _) = one_pixel([512, 256], [255, 127], RADIANCE);
    assert!(direction.dot(Vec3::Z) > 0.999);
    let quarter = one_pixel([512, 256], [127, 127], RADIANCE);
    assert!(quarter.1.dot(Vec3::X) > 0.999);
    let turned = panorama(512, 256, &pixels).surround().turned(PI / 2.0);
    let wanted = panorama(512, 256, &quarter.0).surround();
    for normal in normals() {
        assert_near(turned.polynomial(normal), wanted.polynomial(normal), 1e-4);
    }
}

#[test]
fn a_sun_leaves_no_negative_light_and_keeps_its_mean() {
    let (mut pixels, direction, solid) = one_pixel([512, 256], [100, 90], Vec3::splat(5e4));
    for pixel in &mut pixels {
        *pixel += vec3(0.0, 0.01, 0.02);
    }
    let raw = projected(512, 256, &pixels);
    let windowed = panorama(512, 256, &pixels).surround();
    let lowest = |surround: &Surround| {
        let all = super::super::surround::search_directions();
        all.into_iter().map(|n| surround.polynomial(n).min_element()).fold(f32::INFINITY, f32::min)
    };
    let mean = 5e4 * solid / (4.0 * PI);
    // What is mended must be there without: -0.158 of the mean, the least of 1 + 2 c + 5/4 P2(c).
    assert!((lowest(&raw) / mean + 0.158).abs() < 0.01, "{}", lowest(&raw) / mean);
    // No more is taken away than needed: the least light is just not negative.
    assert!((0.0..1e-3).contains(&(lowest(&windowed) / mean)), "{}", lowest(&windowed) / mean);
    assert_eq!(windowed.mean(), raw.mean());
    // The peak stays the peak, and colours keep their ratio of mean to peak.
    assert!(windowed.polynomial(direction).x > 2.0 * windowed.mean().x);
    for normal in normals() {
        let least = windowed.polynomial(normal).min_element() / mean;
        assert!(least > -1e-3, "{least}");
    }
}

#[test]
fn light_that_does_not_ring_is_not_smoothed() {
    let pixels = noise(64, 32);
    assert_eq!(projected(64, 32, &pixels), panorama(64, 32, &pixels).surround());
}

#[test]
fn black_stays_black() {
    let surround = panorama(4, 2, &[Vec3::ZERO; 8]).surround();
    assert_eq!(surround, Surround::default());
}

#[test]
fn scale_and_uniform_keep_the_coefficients() {
    let surround = panorama(64, 32, &noise(64, 32)).surround();
    let uniform = surround.scaled(2.0).uniform();
    for (vector, sh) in uniform.iter().zip(surround.sh) {
        assert_eq!((vector.truncate(), vector.w), (2.0 * sh, 0.0));
    }
    assert_eq!(size_of_val(&uniform), 9 * 16);
}
