//! What is behind the figure: colours and pictures, on both backends.

use std::sync::Arc;

use crate::common;

use common::{Scene, quad, scene, tuft_scene};
use glam::Vec3;
use lovelock_appearance::environment::{BackdropPicture, BackdropPixels};
use lovelock_render::{Backend, BackgroundForm, Layers, Picture};
use lovelock_testkit::flip;

const SIZE: [u32; 2] = [160, 120];

/// A picture of one grey.
pub(super) fn grey(byte: u8) -> Option<Arc<BackdropPicture>> {
    let pixels = BackdropPixels::Display(vec![[byte, byte, byte, 255]; 16 * 12]);
    BackdropPicture::from_pixels([16, 12], pixels).map(Arc::new)
}

/// A checker of dark red and light blue.
fn checker() -> Option<Arc<BackdropPicture>> {
    let cell = |i: usize| (i % 32 / 4 + i / 32 / 4).is_multiple_of(2);
    let pixels =
        (0..32 * 24).map(|i| if cell(i) { [120, 20, 20, 255] } else { [170, 200, 255, 255] }).collect();
    BackdropPicture::from_pixels([32, 24], BackdropPixels::Display(pixels)).map(Arc::new)
}

fn draw(scene: &Scene, backend: Backend) -> Option<Picture> {
    scene.draw_by(backend, SIZE[0], SIZE[1])
}

fn both(scene: &Scene) -> Option<(Picture, Picture)> {
    Some((draw(scene, Backend::Cpu)?, draw(scene, Backend::Gpu)?))
}

fn at(picture: &Picture, x: u32, y: u32) -> i32 {
    i32::from(common::pixel(picture, x, y)[1])
}

#[test]
fn every_form_of_background_looks_the_same_on_both() {
    let mut s = tuft_scene(300);
    s.picture.background_top = Vec3::new(0.5, 0.1, 0.05);
    s.picture.background_bottom = Vec3::new(0.05, 0.2, 0.6);
    s.backdrop = checker();
    for form in [
        BackgroundForm::Studio,
        BackgroundForm::Plain,
        BackgroundForm::Vertical,
        BackgroundForm::Radial,
        BackgroundForm::Picture,
    ] {
        s.picture.background = form;
        let Some((cpu, gpu)) = both(&s) else { return };
        let difference = flip(&gpu.rgba, &cpu.rgba, SIZE[0], SIZE[1]);
        println!("{form:?}: {difference:?}");
        assert!(difference.mean < 0.005 && difference.p99 < 0.06, "{form:?}: {difference:?}");
    }
    s.picture.background = BackgroundForm::Radial;
    let Some((radial, _)) = both(&s) else { return };
    s.picture.background = BackgroundForm::Vertical;
    let Some((vertical, _)) = both(&s) else { return };
    assert!(flip(&radial.rgba, &vertical.rgba, SIZE[0], SIZE[1]).mean > 0.05, "the control");
}

#[test]
fn forms_of_background_have_their_colours_where_they_say() {
    let mut s = scene(&[]);
    (s.picture.background_top, s.picture.background_bottom) = (Vec3::splat(0.02), Vec3::splat(0.6));
    for backend in [Backend::Cpu, Backend::Gpu] {
        let mut of = |form| {
            s.picture.background = form;
            draw(&s, backend).map(|picture| {
                [at(&picture, 80, 1), at(&picture, 80, 60), at(&picture, 1, 1), at(&picture, 80, 118)]
            })
        };
        let Some([top, middle, corner, bottom]) = of(BackgroundForm::Plain) else { return };
        assert!([middle, corner, bottom].iter().all(|other| (other - top).abs() <= 1), "one colour");
        let [top, middle, corner, bottom] = of(BackgroundForm::Vertical).expect("as before");
        assert!((top - corner).abs() <= 1 && top < middle && middle < bottom, "from top to bottom");
        let [top, middle, corner, bottom] = of(BackgroundForm::Radial).expect("as before");
        assert!(corner < top && top < middle && (top - bottom).abs() <= 1, "from the middle outward");
    }
}

#[test]
fn a_picture_has_its_own_colours_and_none_is_one_colour() {
    let mut s = scene(&[]);
    s.picture.background = BackgroundForm::Picture;
    s.picture.exposure_stops = 1.0;
    s.picture.background_top = Vec3::splat(0.02);
    for backend in [Backend::Cpu, Backend::Gpu] {
        for byte in [30, 128, 250] {
            s.backdrop = grey(byte);
            let Some(picture) = draw(&s, backend) else { return };
            for (x, y) in [(0, 0), (80, 60), (159, 119)] {
                assert!(
                    (at(&picture, x, y) - i32::from(byte)).abs() <= 1,
                    "{backend}: {byte} {}",
                    at(&picture, x, y)
                );
            }
        }
        s.backdrop = None;
        let missing = draw(&s, backend).expect("as before");
        s.picture.background = BackgroundForm::Plain;
        assert!(
            draw(&s, backend).expect("as before") == missing,
            "{backend}: the colour in place of a picture"
        );
        s.picture.background = BackgroundForm::Picture;
    }
}

#[test]
fn the_edge_of_a_body_before_a_bright_picture_is_between_both() {
    let mut s = scene(&[]);
    // A square whose edges cross the columns of pixels.
    s.body = Some(quad(0.0, 0.1, Vec3::splat(0.3)));
    if let Some((_, skin)) = &mut s.body {
        skin.positions.iter_mut().for_each(|p| p.x += 0.2 * p.y);
    }
    s.picture.background = BackgroundForm::Picture;
    for backend in [Backend::Cpu, Backend::Gpu] {
        for byte in [5, 255] {
            s.backdrop = grey(byte);
            let Some(picture) = draw(&s, backend) else { return };
            let inside = at(&picture, 80, 60);
            let mut shared = 0;
            for (y, x) in (45..75).flat_map(|y| (40..120).map(move |x| (y, x))) {
                let here = at(&picture, x, y);
                let (low, high) = (inside.min(i32::from(byte)) - 2, inside.max(i32::from(byte)) + 2);
                assert!((low..=high).contains(&here), "{backend}, {byte}: {here} at {x} {y}");
                shared += i32::from((low + 8..=high - 8).contains(&here));
            }
            assert!(shared >= 20, "{backend}: {shared} pixels are shared");
        }
    }
}

#[test]
fn the_mean_of_layers_before_a_picture_is_the_picture() {
    let mut s = tuft_scene(200);
    s.picture.background = BackgroundForm::Picture;
    s.backdrop = checker();
    for backend in [Backend::Cpu, Backend::Gpu] {
        let Some(picture) = draw(&s, backend) else { return };
        let mean = s.with_renderer(backend, |renderer, input| {
            let (mut mean, mut one) = (Layers::default(), Layers::default());
            mean.clear_to(SIZE[0], SIZE[1]);
            for _ in 0..2 {
                renderer.light(input, SIZE[0], SIZE[1], true, &mut one).expect("light");
                mean.add_light(&one, 0.5);
            }
            let mut picture = Picture::default();
            mean.tone_map(&mut picture);
            picture
        });
        let mean = mean.expect("as before");
        let most = picture.rgba.iter().zip(&mean.rgba).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(most <= Some(2), "{backend}: {most:?}");
    }
}
