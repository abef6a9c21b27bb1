//! Radiance from around the six axes.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::{Vec3, vec3};

use super::super::Environment;
use super::{ROUNDING, assert_near, noise, one_pixel, panorama, shifted};

const AXES: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];

#[test]
fn uniform_light_has_its_radiance_toward_each_axis() {
    let radiance = vec3(0.5, 1.0, 2.0);
    for (width, height) in [(1, 1), (7, 5), (64, 32), (700, 350)] {
        let picture = panorama(width, height, &vec![radiance; width * height]);
        for toward in picture.axis_radiance(0.3) {
            assert_near(toward, radiance, ROUNDING);
        }
    }
}

#[test]
fn sky_above_ground_equals_its_picture() {
    let (sky, ground) = (vec3(1.0, 2.0, 4.0), vec3(0.3, 0.2, 0.1));
    let pixels: Vec<Vec3> = (0..64 * 32).map(|at| if at < 64 * 16 { sky } else { ground }).collect();
    let pictured = Environment::Picture(Arc::new(panorama(64, 32, &pixels))).axis_radiance(0.4);
    let analytic = Environment::SkyAndGround { sky, ground }.axis_radiance(0.4);
    for (found, wanted) in pictured.into_iter().zip(analytic) {
        assert_near(found, wanted, ROUNDING);
    }
    assert_eq!((analytic[2], analytic[3]), (sky, ground));
}

#[test]
fn one_pixel_counts_with_its_squared_cosine() {
    for at in [[100, 40], [255, 200], [300, 3], [511, 128]] {
        let (pixels, direction, solid) = one_pixel([512, 256], at, Vec3::splat(1000.0));
        let found = panorama(512, 256, &pixels).axis_radiance(0.0);
        let scale = 1000.0 * solid / (4.0 * PI / 6.0);
        for (toward, axis) in found.into_iter().zip(AXES) {
            let wanted = scale * direction.dot(axis).max(0.0).powi(2);
            assert!((toward.x - wanted).abs() < 1e-3 * scale, "{at:?} {axis}: {} {wanted}", toward.x);
        }
    }
}

#[test]
fn the_mean_of_the_axes_is_the_mean_of_the_sphere() {
    let picture = panorama(37, 19, &noise(37, 19));
    for turn in [0.0, 0.123, 2.0, -40.0] {
        let sum: Vec3 = picture.axis_radiance(turn).into_iter().sum();
        assert_near(sum / 6.0, picture.surround().mean(), ROUNDING);
    }
}

#[test]
fn a_turn_is_a_shift_by_columns() {
    let mut pixels = noise(64, 32);
    pixels[10 * 64 + 20] = vec3(90.0, 60.0, 30.0);
    let picture = panorama(64, 32, &pixels);
    for columns in [1, 13, 32, 63] {
        let wanted = panorama(64, 32, &shifted(64, &pixels, columns)).axis_radiance(0.0);
        let turn = TAU * columns as f32 / 64.0;
        for (found, wanted) in picture.axis_radiance(turn).into_iter().zip(wanted) {
            assert_near(found, wanted, 5e-5);
        }
        let wrong = picture.axis_radiance(-turn);
        let error = (wrong[0] - wanted[0]).abs().max_element();
        assert!(columns == 32 || error > 1e-2, "the sense of the turn is not seen");
    }
}

#[test]
fn turns_between_the_stored_angles_are_near() {
    let (pixels, direction, solid) = one_pixel([512, 256], [77, 110], Vec3::ONE);
    let picture = panorama(512, 256, &pixels);
    let scale = solid / (4.0 * PI / 6.0);
    for step in 0..300 {
        let turn = 0.021_7 * step as f32;
        let turned = glam::Quat::from_rotation_y(turn) * direction;
        for (toward, axis) in picture.axis_radiance(turn).into_iter().zip(AXES) {
            let wanted = scale * turned.dot(axis).max(0.0).powi(2);
            assert!((toward.x - wanted).abs() < 1e-3 * scale, "{turn} {axis}");
        }
    }
}
