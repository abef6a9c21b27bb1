//! The light that stands out.

use std::f32::consts::PI;

use glam::{Quat, Vec3, vec3};

use super::{assert_near, noise, one_pixel, panorama};

#[test]
fn one_pixel_is_found_with_its_irradiance_and_colour() {
    let radiance = vec3(4000.0, 2000.0, 1000.0);
    for at in [[100, 40], [255, 200], [0, 128], [300, 3]] {
        let (pixels, direction, solid) = one_pixel([512, 256], at, radiance);
        let found = panorama(512, 256, &pixels).strongest().unwrap();
        assert!(found.direction.dot(direction) > 1.0 - 1e-6, "{at:?}: {} {direction}", found.direction);
        assert_near(found.irradiance, radiance * solid, 1e-3);
        assert_near(found.colour(), vec3(1.0, 0.5, 0.25), 1e-5);
    }
}

#[test]
fn the_surroundings_are_not_part_of_the_light() {
    let (mut pixels, direction, solid) = one_pixel([512, 256], [100, 90], Vec3::splat(1e4));
    for pixel in &mut pixels {
        *pixel += vec3(0.2, 0.3, 0.5);
    }
    let found = panorama(512, 256, &pixels).strongest().unwrap();
    assert!(found.direction.dot(direction) > 1.0 - 1e-5);
    assert_near(found.irradiance, Vec3::splat(1e4 * solid), 1e-2);
}

#[test]
fn of_two_lamps_the_brighter_counts_alone() {
    let (mut pixels, direction, _) = one_pixel([512, 256], [100, 90], Vec3::splat(1000.0));
    let weaker = one_pixel([512, 256], [300, 90], Vec3::splat(900.0)).0;
    pixels.iter_mut().zip(weaker).for_each(|(pixel, other)| *pixel += other);
    let found = panorama(512, 256, &pixels).strongest().unwrap();
    assert!(found.direction.dot(direction) > 1.0 - 1e-6);
}

#[test]
fn the_centroid_of_a_disc_is_its_centre() {
    let size = [512, 256];
    let centre = vec3(0.6, 0.48, 0.64);
    let at = |at: usize| one_pixel(size, [at % 512, at / 512], Vec3::ONE).1;
    let pixels: Vec<Vec3> = (0..512 * 256)
        .map(|i| {
            // A direction per pixel, without the picture of it.
            let (u, v) = ((i % 512) as f32 + 0.5, (i / 512) as f32 + 0.5);
            let (azimuth, latitude) = (PI - 2.0 * PI * u / 512.0, PI * (0.5 - v / 256.0));
            let d = vec3(latitude.cos() * azimuth.sin(), latitude.sin(), latitude.cos() * azimuth.cos());
            if d.dot(centre) > 0.99 { Vec3::splat(50.0) } else { Vec3::splat(0.1) }
        })
        .collect();
    assert!(at(0).y > 0.99);
    let found = panorama(512, 256, &pixels).strongest().unwrap();
    assert!(found.direction.dot(centre) > 1.0 - 1e-5, "{}", found.direction);
}

#[test]
fn nothing_stands_out_of_an_even_light() {
    assert_eq!(panorama(64, 32, &vec![Vec3::ONE; 64 * 32]).strongest(), None);
    assert_eq!(panorama(64, 32, &vec![Vec3::ZERO; 64 * 32]).strongest(), None);
    assert_eq!(panorama(64, 32, &noise(64, 32)).strongest(), None);
    let half: Vec<Vec3> = (0..64 * 32).map(|at| if at < 64 * 16 { Vec3::ONE } else { Vec3::ZERO }).collect();
    assert_eq!(panorama(64, 32, &half).strongest(), None);
}

#[test]
fn it_turns_with_the_picture() {
    let (pixels, direction, _) = one_pixel([512, 256], [100, 90], Vec3::ONE);
    let found = panorama(512, 256, &pixels).strongest().unwrap().turned(0.8);
    assert_near(found.direction, Quat::from_rotation_y(0.8) * direction, 1e-5);
}
