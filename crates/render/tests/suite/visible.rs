//! Light that is computed only at the strand points that show: images are the same, and most points of dense hair have none.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_groom::{GroomSettings, GuideFrame, HairShading, PlainHead, Preset, Strands, grow, interpolate};
use lovelock_render::{
    ColorScale, CpuRenderer, FrameInput, FrameStats, Layers, Picture, StrandCount, Transparency,
};
use lovelock_testkit::suite::cases;

use crate::common::{Scene, closed_box, scene, shares_over, slab, soft_wig, tuft, wig};

const SIZE: [u32; 2] = [160, 120];

/// A head of short, curled or long hair with a box in place of the head.
fn head(preset: Preset) -> Scene {
    let settings = GroomSettings { wisps: 80, strands_per_wisp: 12, ..GroomSettings::preset(preset) };
    let style = Arc::new(grow(&settings, &PlainHead.scalp(48), &PlainHead).expect("hair"));
    let mut strands = Strands::default();
    interpolate(&style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
    let mut scene = wig();
    (scene.style, scene.strands, scene.look) = (style, strands, settings.look);
    scene.picture.strand_number = 2_000.0;
    // So dense that hair alone hides what is behind it.
    scene.look.real_hairs *= 3.0;
    let (body, mut skin) = closed_box(true);
    skin.positions.iter_mut().for_each(|p| p.y += 0.08);
    scene.body = Some((body, skin));
    scene
}

/// Cameras: close to the hair, far away, above it, and among it.
fn cameras(scene: &Scene) -> [(&'static str, Vec3); 4] {
    let away = Vec3::new(-0.3, 0.15, -0.9).normalize_or_zero();
    let target = scene.camera.target;
    [
        ("close", target + 0.4 * away),
        ("far", target + 2.5 * away),
        ("above", target + Vec3::new(0.05, 0.9, 0.02)),
        ("inside", target + 0.12 * away),
    ]
}

fn drawn(renderer: &mut CpuRenderer, input: &FrameInput) -> (Picture, FrameStats) {
    let mut picture = Picture::default();
    let stats = renderer.picture(input, SIZE[0], SIZE[1], &mut picture).expect("a picture");
    (picture, stats)
}

fn full() -> CpuRenderer {
    CpuRenderer::default().lighting_hidden_points()
}

/// Draws an input with light at the points that show and at all points, and requires the same image within a step of 255. Returns the number
/// of points whose light was computed, and of all.
fn compared(name: &str, input: &FrameInput) -> [usize; 2] {
    let (mut some, mut all) = (CpuRenderer::default(), full());
    let ((found, stats), (wanted, whole)) = (drawn(&mut some, input), drawn(&mut all, input));
    let [differ, over_one] = shares_over(&wanted, &found, [0, 1]);
    let [lit, points] = some.lit_points();
    println!("{name}: light at {lit} of {points} points, {differ} of the pixels differ");
    assert!(over_one == 0.0, "{name}: {over_one} of the pixels differ by over one step");
    assert_eq!(all.lit_points(), [points; 2], "{name}");
    assert_eq!(
        (stats.mean_transmittance, stats.segments),
        (whole.mean_transmittance, whole.segments),
        "{name}"
    );
    for light in 0..input.lights.len() {
        assert_eq!(some.transmittance(light).ok(), all.transmittance(light).ok(), "{name}");
    }
    [lit, points]
}

#[test]
fn hair_from_anywhere_looks_as_with_light_at_every_point() {
    for &preset in cases(&[Preset::Smooth, Preset::Long], &[Preset::Smooth, Preset::Curly, Preset::Long]) {
        let mut scene = head(preset);
        for (place, eye) in cameras(&scene) {
            scene.camera.eye = eye;
            let [lit, points] = compared(&format!("{preset:?}, {place}"), &scene.input());
            assert!(lit > 0 && lit < points, "{preset:?}, {place}: {lit} of {points}");
            if place == "far" {
                assert!(lit * 4 < points * 3, "a good part is hidden: {lit} of {points}");
            }
        }
    }
}

#[test]
fn every_way_of_drawing_hair_looks_as_with_light_at_every_point() {
    let mut scene = head(Preset::Curly);
    for transparency in Transparency::ALL {
        scene.picture.transparency = transparency;
        let [lit, points] = compared(&transparency.to_string(), &scene.input());
        // The others need the colours of all fragments.
        assert_eq!(lit < points, transparency == Transparency::Sorted, "{transparency}");
    }
    scene.picture.transparency = Transparency::Sorted;
    for (shading, strands) in [
        (HairShading::Fibre, StrandCount::Stored),
        (HairShading::TwoHighlights, StrandCount::BySize),
        (HairShading::KajiyaKayPublished, StrandCount::Fixed),
    ] {
        scene.look.shading = shading;
        scene.picture.strands = strands;
        compared(&format!("{shading:?}, {strands:?}"), &scene.input());
    }
    let draft = FrameInput { is_draft: true, ..scene.input() };
    compared("a draft", &draft);
    compared("before a wall", &soft_wig().input());
}

/// Rows of strands behind each other, each of which covers the whole width by opaque strands.
fn board() -> Scene {
    let mut s = scene(&slab(40, 60));
    // Strands of 6 mm, 5 mm apart.
    (s.look.diameter, s.look.real_hairs, s.look.width_scale) = (6e-3, 40.0 * 60.0, 1.0);
    s
}

#[test]
fn only_the_first_rows_of_a_board_of_hair_need_light() {
    let [lit, points] = compared("a board", &board().input());
    // A row lets through at most about a quarter of the light, so eight of the 60 rows are seen at most, and a little at the border.
    assert!(lit * 4 < points, "{lit} of {points}");
    assert!(lit * 60 > points, "the first row is seen: {lit} of {points}");
    // Control: strands so thin that none hides another.
    let mut thin = board();
    thin.look.diameter = 2e-6;
    let [lit, points] = compared("a thin board", &thin.input());
    assert!(lit * 10 > points * 9, "{lit} of {points}");
}

#[test]
fn every_point_of_a_few_thin_strands_needs_light() {
    let mut s = scene(&tuft(20));
    s.look.diameter = 1e-5;
    let mut renderer = CpuRenderer::default();
    let mut picture = Picture::default();
    renderer.picture(&s.input(), 640, 480, &mut picture).expect("a picture");
    assert_eq!(renderer.lit_points(), [20 * 41; 2]);
    // Beside the image no point needs any.
    s.strands.x.iter_mut().for_each(|x| *x += 5.0);
    renderer.picture(&s.input(), 640, 480, &mut picture).expect("a picture");
    assert_eq!(renderer.lit_points(), [0, 20 * 41]);
}

#[test]
fn the_camera_turns_around_hair_that_rests_and_hair_moves_before_the_camera() {
    let mut scene = head(Preset::Smooth);
    let (mut some, mut all) = (CpuRenderer::default(), full());
    let mut before = Picture::default();
    for step in 0..6 {
        if step < 4 {
            scene.camera.eye = scene.camera.target + Vec3::new(0.8 * (step as f32).sin(), 0.2, -0.8);
        } else {
            scene.strands.y.iter_mut().for_each(|y| *y -= 0.01);
        }
        let (found, _) = drawn(&mut some, &scene.input());
        let (wanted, _) = drawn(&mut all, &scene.input());
        assert_eq!(shares_over(&wanted, &found, [1]), [0.0], "step {step}");
        assert!(found != before, "control: step {step} is seen");
        before = found;
    }
}

#[test]
fn layers_and_false_colours_are_those_of_light_at_every_point() {
    let scene = head(Preset::Smooth);
    let (mut some, mut all) = (CpuRenderer::default(), full());
    let layers = |renderer: &mut CpuRenderer| {
        let mut layers = Layers::default();
        renderer.layers(&scene.input(), SIZE[0], SIZE[1], true, &mut layers).expect("layers");
        layers
    };
    let (found, wanted) = (layers(&mut some), layers(&mut all));
    let lights = found.light.iter().flatten().zip(wanted.light.iter().flatten());
    let most = lights.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    // A pixel leaves out at most 1/16,384 of light of a few times white.
    assert!(most < 1e-3, "{most}");
    assert!(found.depth == wanted.depth && found.transmittance == wanted.transmittance);
    let values: Vec<f32> = (0..scene.style.strands.count()).map(|strand| (strand % 7) as f32).collect();
    let scale = ColorScale {
        range: [0.0, 6.0],
        colors: std::array::from_fn(|k| [255 - k as u8, k as u8, 77]),
        behind: 0.3,
        saturation: 0.0,
        relief: 0.5,
    };
    let colored = |renderer: &mut CpuRenderer| {
        let mut picture = Picture::default();
        renderer.strand_colors(&scene.input(), SIZE, (&values, &scale), &mut picture).expect("a picture");
        picture
    };
    assert_eq!(shares_over(&colored(&mut all), &colored(&mut some), [1]), [0.0]);
}
