//! Light that stands somewhere, with results known on paper.

use glam::Vec3;
use lovelock_render::{Camera, Light, LightKind, ShadowMethod, ShadowSettings};
use lovelock_testkit::suite::{cases, sample};

use super::{BACKEND, curtain, sum};
use crate::common::{self, Scene, pixel, quad, scene};

/// A lamp at `position` that shines toward `target`.
fn lamp(kind: LightKind, position: Vec3, target: Vec3) -> Light {
    let direction = (target - position).normalize_or(Vec3::NEG_Y);
    Light { kind, position, direction, radius: 0.002, specular: 0.0, ..Light::default() }
}

/// A wall at z = 0, seen from the front.
fn wall(lights: Vec<Light>) -> Scene {
    let mut s = scene(&[]);
    s.body = Some(common::grid(0.0, 0.5, 64, Vec3::splat(0.5)));
    s.lights = lights;
    s.picture.ambient = 0.0;
    s.camera =
        Camera { eye: Vec3::new(0.0, 0.0, 1.0), target: Vec3::ZERO, fov_y: 0.6, shear: glam::Vec2::ZERO };
    s
}

#[test]
fn light_falls_with_the_square_of_the_distance() {
    let at = |distance: f32, intensity: f32| {
        let light = lamp(LightKind::Point, Vec3::new(0.0, 0.0, distance), Vec3::ZERO);
        let s = wall(vec![Light { intensity, ..light }]);
        s.draw_by(BACKEND, 64, 64).map(|picture| sum(pixel(&picture, 32, 32)))
    };
    let Some(near) = at(1.0, 2.0) else { return };
    let far = at(3.0, 18.0).expect("an adapter");
    assert!(near > 150 && near.abs_diff(far) <= 3, "{near} at 1 m, {far} at 3 m");
    // The directional light of the same brightness is as bright as a lamp at one metre.
    let directional = Light { intensity: 2.0, specular: 0.0, direction: Vec3::NEG_Z, ..Light::default() };
    let even = wall(vec![directional]).draw_by(BACKEND, 64, 64).expect("an adapter");
    assert!(sum(pixel(&even, 32, 32)).abs_diff(near) <= 3, "{} and {near}", sum(pixel(&even, 32, 32)));
    let dim = at(3.0, 2.0).expect("an adapter");
    assert!(dim * 2 < near, "the control: {dim} at 3 m without more light");
}

#[test]
fn a_spot_lights_its_cone_alone() {
    let of = |inner_angle: f32, outer_angle: f32, position: Vec3| {
        let light = lamp(LightKind::Spot, position, Vec3::ZERO);
        let s = wall(vec![Light { inner_angle, outer_angle, intensity: 3.0, ..light }]);
        let picture = s.draw_by(BACKEND, 96, 96)?;
        // The middle, 0.1 m beside it, and 0.2 m beside it.
        Some([48, 63, 78].map(|x| sum(pixel(&picture, x, 48))))
    };
    let before = Vec3::new(0.0, 0.0, 1.0);
    // Half angles of 8.6 degrees: 0.15 m on the wall.
    let Some([middle, within, without]) = of(0.28, 0.3, before) else { return };
    assert!(middle > 200 && within > 200, "{middle}, {within}");
    assert_eq!(without, 0, "outside the cone");
    let [_, soft, _] = of(0.1, 0.3, before).expect("an adapter");
    assert!(soft > 20 && soft + 40 < within, "a soft edge: {soft} of {within}");
    assert_eq!(of(0.0, 0.0, before).expect("an adapter"), [0; 3], "a cone of nothing");
    let [_, _, half] = of(3.2, 3.2, before).expect("an adapter");
    assert!(half > 200, "a half space: {half}");
    // Turned away, the wall is behind it.
    let light = lamp(LightKind::Spot, before, Vec3::new(0.0, 0.0, 5.0));
    let picture = wall(vec![light]).draw_by(BACKEND, 96, 96).expect("an adapter");
    assert_eq!(sum(pixel(&picture, 48, 48)), 0, "behind the spot");
}

#[test]
fn hair_before_a_lamp_shadows_the_wall() {
    // The lamp is on the line through the middle of the hair and the place on the wall at which the camera looks: near the hair, where
    // the sides of a cube around it are looked up, and far from it.
    for distance in cases(&[0.03, 0.9], &[0.03, 0.3, 0.9]).iter().copied() {
        let at = |hair: bool, method| {
            let lines = if hair { curtain(400, 0.1, 0.1) } else { Vec::new() };
            let mut s = scene(&lines);
            s.body = Some(common::grid(0.0, 0.4, 64, Vec3::splat(0.5)));
            s.look.real_hairs = 100_000.0;
            s.look.width_scale = 0.01;
            let position = Vec3::new(0.0, distance, 0.1 + distance);
            let light = lamp(LightKind::Point, position, Vec3::new(0.0, -0.1, 0.0));
            let way = 2.0 * (0.1 + distance) * (0.1 + distance);
            s.lights = vec![Light { intensity: 3.0 * way, ..light }];
            s.shadow = ShadowSettings { method, ..ShadowSettings::default() };
            s.picture.ambient = 0.0;
            let target = Vec3::new(0.0, -0.1, 0.0);
            s.camera = Camera { eye: target + Vec3::Z, target, fov_y: 0.3, shear: glam::Vec2::ZERO };
            s.draw_by(BACKEND, 96, 96).map(|picture| sum(pixel(&picture, 48, 48)))
        };
        let Some(free) = at(false, ShadowMethod::VoxelMap) else { return };
        let unshadowed = at(true, ShadowMethod::None).expect("an adapter");
        assert!(free > 120, "a lit wall: {free}");
        assert!(unshadowed.abs_diff(free) < 10, "the control: {unshadowed} against {free}");
        let all = [ShadowMethod::VoxelMap, ShadowMethod::DeepOpacityMaps, ShadowMethod::Exact];
        for method in sample(all, 2) {
            let shadowed = at(true, method).expect("an adapter");
            assert!(shadowed * 3 < free * 2, "{distance} m, {method}: {shadowed} against {free}");
        }
    }
}

#[test]
fn hair_and_body_shadow_the_ground_under_a_lamp() {
    let ground = |hair: bool, body: bool, height: f32| {
        let lines: Vec<_> = curtain(400, 0.4, 0.0)
            .into_iter()
            .map(|line| line.into_iter().map(|p| Vec3::new(p.x, 0.5, p.y)).collect())
            .collect();
        let mut s = scene(if hair { &lines } else { &[] });
        s.look.real_hairs = 100_000.0;
        s.look.width_scale = 0.01;
        if body {
            let mut board = quad(0.0, 0.2, Vec3::splat(0.5));
            board.1.positions.iter_mut().for_each(|p| *p = Vec3::new(p.x, 0.5, -p.y));
            s.body = Some(board);
        }
        let light = lamp(LightKind::Point, Vec3::new(0.0, height, 0.0), Vec3::ZERO);
        s.lights = vec![Light { intensity: 3.0 * height * height, ..light }];
        s.shadow.method = ShadowMethod::Exact;
        s.picture.ground = true;
        (s.picture.background_top, s.picture.background_bottom) = (Vec3::splat(0.3), Vec3::splat(0.3));
        s.camera =
            Camera { eye: Vec3::new(0.0, 0.3, 1.5), target: Vec3::ZERO, fov_y: 0.3, shear: glam::Vec2::ZERO };
        s.draw_by(BACKEND, 96, 96).map(|picture| sum(pixel(&picture, 48, 48)))
    };
    // At 0.55 m the hair and the board take in more than one view.
    for height in [0.55, 2.0] {
        let Some(free) = ground(false, false, height) else { return };
        let [hair, body] = [(true, false), (false, true)]
            .map(|(hair, body)| ground(hair, body, height).expect("an adapter"));
        assert!(hair * 10 < free * 9, "{height} m, hair: {hair} against {free}");
        assert!(body * 10 < free * 8, "{height} m, a board: {body} against {free}");
    }
}

#[test]
fn a_board_shadows_hair_from_a_lamp_and_not_from_one_between_them() {
    let behind = |blocker: bool, z: f32| {
        let mut s = scene(&curtain(100, 0.05, 0.0));
        if blocker {
            s.body = Some(quad(0.3, 0.1, Vec3::splat(0.5)));
        }
        let light = lamp(LightKind::Point, Vec3::new(0.0, 0.0, z), Vec3::ZERO);
        s.lights = vec![Light { intensity: 3.0 * z * z, ..light }];
        s.camera = Camera {
            eye: Vec3::new(0.6, 0.0, 0.25),
            target: Vec3::ZERO,
            fov_y: 0.2,
            shear: glam::Vec2::ZERO,
        };
        s.picture.ambient = 0.1;
        s.look.diameter = 0.002;
        s.look.width_scale = 1.0;
        s.draw_by(BACKEND, 64, 64).map(|p| sum(pixel(&p, 32, 32)))
    };
    let Some(lit) = behind(false, 1.0) else { return };
    let dark = behind(true, 1.0).expect("an adapter");
    assert!(dark * 2 < lit, "hair behind a board: {dark} against {lit}");
    let (lit, between) = (behind(false, 0.2).expect("one"), behind(true, 0.2).expect("an adapter"));
    assert!(between.abs_diff(lit) * 20 < lit, "the lamp is before the board: {between} against {lit}");
}

#[test]
fn a_flat_surface_keeps_no_light_of_a_lamp_from_itself() {
    for way in [Vec3::new(0.3, -0.3, -1.0), Vec3::new(1.0, -0.5, -0.7)] {
        for (distance, radius) in [(6.0, 0.002), (6.0, 0.5), (30.0, 0.001)] {
            let mut s = scene(&curtain(1, 0.1, -1.0));
            s.body = Some(common::grid(0.0, 0.5, 8, Vec3::splat(0.4)));
            let light = lamp(LightKind::Point, -distance * way.normalize_or_zero(), Vec3::ZERO);
            s.lights = vec![Light { intensity: 0.5 * distance * distance, radius, ..light }];
            s.camera.fov_y = 0.4;
            let Some(picture) = s.draw_by(BACKEND, 96, 96) else { return };
            let red: Vec<f32> = picture.rgba.iter().step_by(4).map(|&c| f32::from(c)).collect();
            let mean = red.iter().sum::<f32>() / red.len() as f32;
            let worst = red.iter().map(|c| (c - mean).abs()).fold(0.0, f32::max);
            // From corner to corner the light itself changes by a twentieth.
            assert!(
                mean > 40.0 && worst < 5.0,
                "{way}, {distance}, {radius}: mean {mean}, at most {worst} from it"
            );
        }
    }
}

#[test]
fn lamps_anywhere_give_a_picture_without_holes() {
    let eye = Vec3::Z;
    let places = [
        eye,
        Vec3::new(0.05, 0.01, 0.0),
        Vec3::splat(1000.0),
        Vec3::NAN,
        Vec3::splat(1e30),
        Vec3::new(0.0, 0.0, 0.001),
    ];
    for first in cases(&[0], &[0, 1]) {
        for (i, (position, angle)) in places.into_iter().zip([0.0, 1.0, 4.0, f32::NAN, 3.1, 0.5]).enumerate()
        {
            let kind = [LightKind::Spot, LightKind::Point][(first + i) % 2];
            let mut s = scene(&curtain(50, 0.1, 0.0));
            s.body = Some(common::closed_box(true));
            s.shadow.method = ShadowMethod::Exact;
            let light =
                Light { position, outer_angle: angle, inner_angle: angle, ..lamp(kind, position, Vec3::X) };
            s.lights = vec![light; 5];
            (s.picture.background_top, s.picture.background_bottom) = (Vec3::splat(0.2), Vec3::splat(0.2));
            s.picture.ground = true;
            let Some(picture) = s.draw_by(BACKEND, 48, 32) else { return };
            assert!(sum(pixel(&picture, 1, 1)) > 60, "{kind:?} at {position}");
        }
    }
}
