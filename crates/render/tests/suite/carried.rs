//! Hair that the skin carries, beside the hairstyle, on both backends.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{COLOUR_SAMPLES, HairLook, StrandColour, StrandColours};
use lovelock_render::{
    Backend, CarriedHair, FrameInput, FrameStats, Layers, Picture, PictureSettings, Renderer, Transparency,
};
use lovelock_testkit::flip;

use crate::common::{Scene, scene, soft_wig};

const SIZE: [u32; 2] = [240, 200];
/// Strands of the brow.
const STRANDS: usize = 1500;

/// A brow of black strands before the hair of [`soft_wig`], as seen by its camera: about 0.3 mm wide.
fn brow() -> (Scene, HairLook) {
    let line = |i: usize| -> Vec<Vec3> {
        let (row, column) = (i % 30, i / 30);
        let at = Vec3::new(-0.05 + 0.001 * column as f32, 0.03 + 0.002 * row as f32, 0.17);
        (0..7).map(|k| at + Vec3::new(0.002 * k as f32, 0.0005 * k as f32, 0.0)).collect()
    };
    let mut brow = scene(&(0..STRANDS).map(line).collect::<Vec<_>>());
    let mut style = (*brow.style).clone();
    let black = StrandColour { kept: 0.0, added: [4.0, 6.0, 9.0] };
    style.strands.colours = StrandColours::new(vec![[black; COLOUR_SAMPLES]; STRANDS]);
    for (i, taper) in style.strands.taper.iter_mut().enumerate() {
        *taper = 1.0 - 0.1 * (i % 7) as f32;
    }
    brow.style = Arc::new(style);
    let look =
        HairLook { diameter: 3e-4, real_hairs: STRANDS as f32, width_scale: 1.0, ..HairLook::default() };
    (brow, look)
}

/// Draws a scene with or without a brow.
fn drawn(scene: &Scene, backend: Backend, with_brow: bool) -> Option<(Picture, FrameStats)> {
    with_brow_input(scene, backend, with_brow, |renderer, input| {
        let mut picture = Picture::default();
        let stats = renderer.picture(input, SIZE[0], SIZE[1], &mut picture).expect("a picture");
        (picture, stats)
    })
}

fn with_brow_input<T>(
    scene: &Scene,
    backend: Backend,
    with_brow: bool,
    of: impl FnOnce(&mut Renderer, &FrameInput) -> T,
) -> Option<T> {
    let (brow, look) = brow();
    scene.with_renderer(backend, |renderer, input| {
        let carried = CarriedHair { style: &brow.style, strands: &brow.strands, look };
        of(renderer, &FrameInput { carried: with_brow.then_some(carried), ..*input })
    })
}

/// By how much darker the first picture is, as the sum over pixels of what red lacks.
fn darker(a: &Picture, b: &Picture) -> f64 {
    let red = |picture: &Picture| picture.rgba.iter().step_by(4).map(|v| f64::from(*v)).sum::<f64>();
    red(b) - red(a)
}

#[test]
fn it_is_drawn_alike_by_both_backends_in_every_mode_and_leaves_statistics_alone() {
    for transparency in Transparency::ALL {
        let mut scene = soft_wig();
        scene.picture.transparency = transparency;
        let (with, stats) = drawn(&scene, Backend::Cpu, true).expect("the processor");
        let (without, plain) = drawn(&scene, Backend::Cpu, false).expect("the processor");
        assert_eq!(stats.segments, plain.segments);
        assert_eq!(stats.mean_transmittance, plain.mean_transmittance);
        assert_eq!(stats.shadow_bytes, plain.shadow_bytes);
        let seen = flip(&with.rgba, &without.rgba, SIZE[0], SIZE[1]);
        // Measured 0.0006 to 0.0024: black strands over dark hair.
        assert!(seen.mean > 0.0003, "{transparency}: {seen:?}");
        let Some((by_card, of_card)) = drawn(&scene, Backend::Gpu, true) else { return };
        let (plain_by_card, plain) = drawn(&scene, Backend::Gpu, false).expect("as before");
        assert_eq!(
            (of_card.segments, of_card.mean_transmittance),
            (plain.segments, plain.mean_transmittance)
        );
        let [difference, usual] = [(&by_card, &with), (&plain_by_card, &without)]
            .map(|(a, b)| flip(&a.rgba, &b.rgba, SIZE[0], SIZE[1]));
        println!("{transparency}: {difference:?}, without {usual:?}, seen {seen:?}");
        // Not much more than without it; the control is an image without it, which `seen` is.
        assert!(difference.mean < usual.mean + 0.3 * seen.mean, "{transparency}: {difference:?} {usual:?}");
    }
}

#[test]
fn its_width_does_not_depend_on_the_strands_of_the_hairstyle() {
    let darkness = |number: f32, look: HairLook| {
        let mut scene = soft_wig();
        (scene.picture.strand_number, scene.look) = (number, look);
        // Hair that lets all light through, before a white square, leaves the brow alone.
        scene.look.width_scale = 0.05;
        scene.look.real_hairs = 1.0;
        let (with, _) = drawn(&scene, Backend::Cpu, true).expect("the processor");
        let (without, _) = drawn(&scene, Backend::Cpu, false).expect("the processor");
        darker(&with, &without)
    };
    let usual = soft_wig().look;
    let many = darkness(2000.0, usual);
    for few in [darkness(128.0, usual), darkness(2000.0, HairLook { diameter: 17e-6, ..usual })] {
        assert!((few / many - 1.0).abs() < 0.005, "{few} and {many}");
    }
}

#[test]
fn hair_before_it_shadows_it_and_the_next_picture_forgets_it() {
    let mut scene = soft_wig();
    let plain = drawn(&scene, Backend::Cpu, false).expect("the processor").0;
    drawn(&scene, Backend::Cpu, true).expect("the processor");
    let again = drawn(&scene, Backend::Cpu, false).expect("the processor").0;
    assert_eq!(plain.rgba, again.rgba);
    scene.picture = PictureSettings { ambient: 0.0, ..scene.picture };
    let light = |scene: &Scene| {
        let layers = with_brow_input(scene, Backend::Cpu, true, |renderer, input| {
            let mut layers = Layers::default();
            renderer.layers(input, SIZE[0], SIZE[1], true, &mut layers).expect("layers");
            layers
        });
        let layers = layers.expect("the processor");
        assert!(layers.transmittance.iter().all(|t| (0.0..=1.0).contains(t)));
        layers
    };
    let nearest = |layers: &Layers| layers.depth.iter().copied().fold(f32::INFINITY, f32::min);
    let with = light(&scene);
    // The brow is 0.17 m before the head's joint.
    assert!(nearest(&with) < scene.camera.eye.distance(Vec3::new(0.0, 0.04, 0.17)) + 0.1);
}
