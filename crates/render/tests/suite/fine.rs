//! Fine strands: their number changes the grain of an image and nothing else.

use crate::common;

use std::sync::Arc;

use common::{Scene, scene};
use glam::{Affine3A, Vec3};
use lovelock_groom::{GroomSettings, GuideFrame, Hairstyle, PlainHead, Strands, grow, interpolate};
use lovelock_render::{
    Backend, CpuRenderer, FrameInput, FrameStats, Layers, Light, Picture, ShadowMethod, StrandCount,
};
use lovelock_testkit::flip;

/// A head of short hair of 2,000 strands, without the head.
fn wig() -> Scene {
    let settings = GroomSettings { wisps: 100, strands_per_wisp: 20, ..GroomSettings::default() };
    let style: Arc<Hairstyle> = Arc::new(grow(&settings, &PlainHead.scalp(48), &PlainHead).expect("hair"));
    let mut strands = Strands::default();
    interpolate(&style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
    let mut scene = scene(&[]);
    (scene.style, scene.strands, scene.look) = (style, strands, settings.look);
    scene.shadow.method = ShadowMethod::VoxelMap;
    scene.lights = Light::default_rig();
    scene.camera.target = Vec3::new(0.0, 0.08, 0.0);
    scene.camera.eye = scene.camera.target + Vec3::new(-0.3, 0.15, -0.9);
    scene.picture.strands = StrandCount::Fixed;
    scene
}

fn drawn(renderer: &mut CpuRenderer, scene: &Scene, side: u32) -> (f64, FrameStats) {
    let mut layers = Layers::default();
    let stats = renderer.layers(&scene.input(), side, side, false, &mut layers).expect("layers");
    let sum: f64 =
        layers.light.iter().map(|[r, g, b, _]| f64::from(0.2126 * r + 0.7152 * g + 0.0722 * b)).sum();
    (sum / f64::from(side * side), stats)
}

#[test]
fn the_number_of_strands_changes_neither_brightness_nor_shadow() {
    let mut scene = wig();
    let mut renderer = CpuRenderer::default();
    for (distance, side) in [(0.9, 320), (3.0, 320)] {
        scene.camera.eye = scene.camera.target + Vec3::new(-0.3, 0.15, -0.9).normalize_or_zero() * distance;
        let mut found = Vec::new();
        let (few, all) = ([3_000.0, 100_000.0], [3_000.0, 10_000.0, 30_000.0, 100_000.0]);
        for &count in lovelock_testkit::suite::cases(&few, &all) {
            scene.picture.strand_number = count;
            let (luminance, stats) = drawn(&mut renderer, &scene, side);
            println!(
                "{distance} m, {count}: luminance {luminance:.5}, transmittance {}",
                stats.mean_transmittance
            );
            found.push((luminance, stats.mean_transmittance));
        }
        let luminance = found.iter().map(|of| of.0).sum::<f64>() / found.len() as f64;
        let transmittance = found[found.len() - 1].1;
        for &(other, t) in &found {
            assert!((other / luminance - 1.0).abs() < LUMINANCE, "{found:?}");
            assert!((t - transmittance).abs() < 0.01, "{found:?}");
        }
        // The control: hair of a fifth more width.
        scene.look.real_hairs *= 1.2;
        let (wider, stats) = drawn(&mut renderer, &scene, side);
        scene.look.real_hairs /= 1.2;
        let thinner = transmittance - stats.mean_transmittance;
        assert!(thinner > 0.01, "{wider} {luminance} {thinner}");
    }
}

/// Difference of the luminance of a number of strands from the mean of all.
const LUMINANCE: f64 = 0.02;

#[test]
fn nothing_appears_at_once_while_the_camera_comes_closer() {
    let mut scene = wig();
    let mut renderer = CpuRenderer::default();
    // The largest change of the mean of 8 by 8 pixels from image to image: what an eye sees as a jump.
    let mut largest = |scene: &mut Scene, strands: StrandCount| {
        scene.picture.strands = strands;
        scene.picture.strand_number = 6_000.0;
        let (mut before, mut most): (Option<Vec<f64>>, f64) = (None, 0.0);
        let mut counts = Vec::new();
        for step in 0..12 {
            let distance = 1.6 - 0.004 * f64::from(step);
            let away = Vec3::new(-0.3, 0.15, -0.9).normalize_or_zero();
            scene.camera.eye = scene.camera.target + away * distance as f32;
            let mut picture = Picture::default();
            let stats = renderer.picture(&scene.input(), 256, 256, &mut picture).expect("a picture");
            counts.push(stats.segments);
            let mut blocks = vec![0.0; 32 * 32];
            for (i, pixel) in picture.rgba.chunks_exact(4).enumerate() {
                let block = i / 256 / 8 * 32 + i % 256 / 8;
                blocks[block] += pixel[..3].iter().map(|&c| f64::from(c)).sum::<f64>() / (3.0 * 64.0);
            }
            if let Some(before) = &before {
                let change = blocks.iter().zip(before).map(|(a, b)| (a - b).abs());
                most = change.fold(most, f64::max);
            }
            before = Some(blocks);
        }
        (most, counts)
    };
    let (fixed, _) = largest(&mut scene, StrandCount::Fixed);
    let (by_size, counts) = largest(&mut scene, StrandCount::BySize);
    println!("largest change of a block: fixed {fixed:.3}, by size {by_size:.3}; segments {counts:?}");
    assert!(counts.windows(2).any(|two| two[0] != two[1]), "the number follows the distance");
    assert!(by_size < fixed + 1.0, "{by_size} {fixed}");
}

#[test]
fn both_backends_draw_the_same_fine_strands() {
    let mut scene = wig();
    scene.picture.strand_number = 9_000.0;
    let (w, h) = (240, 240);
    let Some(card) = scene.draw_by(Backend::Gpu, w, h) else { return };
    let processor = scene.draw_by(Backend::Cpu, w, h).expect("a picture");
    scene.picture.strand_number = 6_000.0;
    let fewer = scene.draw_by(Backend::Cpu, w, h).expect("a picture");
    let difference = flip(&card.rgba, &processor.rgba, w, h);
    let control = flip(&card.rgba, &fewer.rgba, w, h);
    println!("{difference:?}; other strands {control:?}");
    // Measured on a software adapter: mean 0.0002, where the control has 0.0085.
    assert!(difference.mean < 0.001, "{difference:?}");
    assert!(control.mean > 0.004, "{control:?}");
}

#[test]
fn both_backends_soften_the_shadow_of_hair_on_a_body() {
    let mut scene = wig();
    scene.body = Some(common::grid(-0.16, 0.3, 60, Vec3::splat(0.6)));
    scene.camera.eye = scene.camera.target + Vec3::new(-0.5, 0.15, 0.6);
    scene.lights.truncate(1);
    scene.lights[0].direction = Vec3::new(0.25, -0.1, -1.0);
    scene.picture.strand_number = 3_000.0;
    let (w, h) = (240, 240);
    let Some(card) = scene.draw_by(Backend::Gpu, w, h) else { return };
    let processor = scene.draw_by(Backend::Cpu, w, h).expect("a picture");
    scene.lights[0].softness = 0.0;
    let [hard_card, hard] =
        [Backend::Gpu, Backend::Cpu].map(|backend| scene.draw_by(backend, w, h).expect("a picture"));
    let difference = flip(&card.rgba, &processor.rgba, w, h);
    let plain = flip(&hard_card.rgba, &hard.rgba, w, h);
    let control = flip(&card.rgba, &hard.rgba, w, h);
    println!("{difference:?}; without size {plain:?}; one of each {control:?}");
    // The wall's edge is smoothed by the card alone.
    assert!(difference.mean < plain.mean + 0.001, "{difference:?} {plain:?}");
    assert!(control.mean > 0.03, "{control:?}");
}

#[test]
fn a_draft_is_near_the_image_that_follows_it() {
    let mut scene = wig();
    scene.picture.strands = StrandCount::BySize;
    scene.camera.eye = scene.camera.target + Vec3::new(-0.3, 0.15, -0.9).normalize_or_zero() * 1.2;
    let (w, h) = (320, 320);
    let mut drawn = |is_draft: bool, scale: f32| {
        scene.picture.exposure_stops = scale;
        let mut picture = Picture::default();
        let input = FrameInput { is_draft, ..scene.input() };
        let stats = CpuRenderer::default().picture(&input, w, h, &mut picture).expect("a picture");
        (picture.rgba, stats.segments)
    };
    let ((whole, many), (draft, fewer), (brighter, _)) =
        (drawn(false, 0.0), drawn(true, 0.0), drawn(false, 1.0));
    let (difference, control) = (flip(&whole, &draft, w, h), flip(&whole, &brighter, w, h));
    println!("a draft {difference:?} with {fewer} of {many} segments; a stop brighter {control:?}");
    assert!(fewer < many && fewer > many / 3);
    assert!(difference.mean < 0.5 * control.mean, "{difference:?} {control:?}");
}

#[test]
fn strands_that_belong_to_no_hairstyle_are_drawn_as_they_are() {
    let mut scene = wig();
    let whole = drawn(&mut CpuRenderer::default(), &scene, 64).1.segments;
    // One strand less than the hairstyle has.
    let ends = scene.strands.first_point.len() - 1;
    let points = scene.strands.first_point[ends - 1] as usize;
    scene.strands.first_point = scene.strands.first_point[..ends].into();
    for axis in [&mut scene.strands.x, &mut scene.strands.y, &mut scene.strands.z] {
        axis.truncate(points);
    }
    let odd = drawn(&mut CpuRenderer::default(), &scene, 64).1.segments;
    assert!(odd < whole && odd > 0, "{odd} {whole}");
}
