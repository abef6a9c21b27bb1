//! The published model of Kajiya and Kay, against its equation on paper.

use crate::common;

use common::{Scene, scene, tuft_scene};
use glam::Vec3;
use lovelock_groom::{HairLook, HairShading};
use lovelock_render::{Backend, CpuRenderer, FrameInput, KnownTransmittance, Layers, Light};
use lovelock_testkit::flip;

/// The radiance from all directions.
const AROUND: Vec3 = Vec3::new(0.3, 0.2, 0.1);
const IRRADIANCE: Vec3 = Vec3::new(3.0, 2.0, 1.0);

/// A strand of one centimetre along +X, seen from +Z, in light from `to_light` and from all directions.
fn one(to_light: Vec3, shading: HairShading) -> Scene {
    let mut s = scene(&[(0..=20).map(|i| Vec3::X * (0.0005 * i as f32 - 0.005)).collect()]);
    s.camera.fov_y = 0.05;
    // Narrow, because wide strands are streaked.
    s.look = HairLook {
        shading,
        variation: 0.0,
        tip_lightening: 0.0,
        real_hairs: 10.0,
        roughness: 0.3,
        primary_strength: 0.7,
        ..s.look
    };
    s.lights = vec![Light { direction: -to_light, color: IRRADIANCE, intensity: 1.0, ..Light::default() }];
    s.surroundings = Some(common::panorama(|_, _| AROUND));
    s
}

/// The light of the hair, where it transmits `lit` of the light.
fn seen(s: &Scene, lit: f32) -> Vec3 {
    let at_points = vec![vec![lit; s.strands.points()]];
    let known = Some(KnownTransmittance { at_points: &at_points, at_vertices: &[] });
    let mut layers = Layers::default();
    let input = FrameInput { known, ..s.input() };
    CpuRenderer::default().layers(&input, 64, 64, false, &mut layers).expect("layers");
    let (mut sum, mut covered) = (Vec3::ZERO, 0.0);
    for &[r, g, b, alpha] in &layers.light {
        sum += Vec3::new(r, g, b);
        covered += alpha;
    }
    sum / covered
}

#[test]
fn light_on_a_strand_is_that_of_the_equation() {
    for (to_light, lit) in [
        (Vec3::new(0.0, 0.6, 0.8), 1.0),
        (Vec3::new(0.0, 0.6, 0.8), 0.6),
        (Vec3::new(0.2, 0.5, 0.7), 1.0),
        (Vec3::new(0.6, -0.8, 0.0), 1.0),
        // Along the strand, and at its shadow side.
        (Vec3::X, 1.0),
        (Vec3::new(0.0, 0.1, -1.0), 0.2),
    ] {
        let to_light = to_light.normalize_or(Vec3::Z);
        let s = one(to_light, HairShading::KajiyaKayPublished);
        let hair = HairLook::body_color(s.look.absorption());
        // sin(t, l), and the same of the eye, which sees the strand from the side: the highlight is sin(t, l)^p.
        let across = to_light.with_x(0.0).length();
        let shine = s.lights[0].specular * s.look.primary_strength * across.powf(80.0);
        let direct = IRRADIANCE * (hair * across + shine) / std::f32::consts::PI;
        let expected = hair * AROUND + lit * direct;
        let found = seen(&s, lit);
        println!("from {to_light}, transmittance {lit}: {found}, on paper {expected}");
        // The eye is 1 m away and not infinitely far: measured 0.4 % and less.
        assert!((found / expected - 1.0).abs().max_element() < 0.01, "{found} {expected}");
        // The control: the model with two highlights has neither this light nor this colour. Along the strand both have none.
        if across < 0.1 {
            continue;
        }
        let other = seen(&one(to_light, HairShading::TwoHighlights), lit);
        assert!((other / expected - 1.0).abs().max_element() > 0.03, "{other} {expected}");
    }
}

#[test]
fn ambient_light_is_not_shadowed_by_hair() {
    let ambient = |shading, lit| {
        let mut s = one(Vec3::Z, shading);
        s.lights[0].intensity = 0.0;
        seen(&s, lit)
    };
    let [inside, outside] = [0.0, 1.0].map(|lit| ambient(HairShading::KajiyaKayPublished, lit));
    assert!(inside == outside && inside.min_element() > 0.0, "{inside} {outside}");
    // The control is less than a quarter as bright inside.
    let [inside, outside] = [0.0, 1.0].map(|lit| ambient(HairShading::TwoHighlights, lit));
    assert!(inside.element_sum() < 0.25 * outside.element_sum(), "{inside} {outside}");
}

#[test]
fn both_backends_draw_the_published_model_alike() {
    let (w, h) = (240, 180);
    let mut s = tuft_scene(400);
    s.look.shading = HairShading::KajiyaKayPublished;
    let Some(gpu) = s.draw_by(Backend::Gpu, w, h) else { return };
    let cpu = s.draw_by(Backend::Cpu, w, h).expect("a picture");
    s.look.shading = HairShading::TwoHighlights;
    let other = s.draw_by(Backend::Cpu, w, h).expect("a picture");
    let difference = flip(&gpu.rgba, &cpu.rgba, w, h);
    let control = flip(&gpu.rgba, &other.rgba, w, h);
    println!("{difference:?}; two highlights {control:?}");
    assert!(difference.mean < 0.005 && difference.p99 < 0.06, "{difference:?}");
    assert!(control.mean > 3.0 * difference.mean, "{control:?}");
}
