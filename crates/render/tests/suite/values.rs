//! Images of values per strand point, and the hair under a pixel.

use crate::common;

use common::{Scene, pixel, quad, scene, tuft_scene};
use glam::Vec3;
use lovelock_render::{Backend, FrameInput, HairHit, RenderError, Transparency, ValuePicture, ValueRenderer};

const BACKEND: Backend = Backend::Cpu;
const SIDE: u32 = 64;

/// A vertical strand at `x` and `z` in front of the origin, with 11 points from 5 cm above to 5 cm below.
fn upright(x: f32, z: f32) -> Vec<Vec3> {
    (0..11).map(|j| Vec3::new(x, 0.05 - 0.01 * j as f32, z)).collect()
}

/// Strands wide enough that each fills the middle of the picture.
fn wide(lines: &[Vec<Vec3>], opacity: f32) -> Scene {
    let mut s = scene(lines);
    (s.look.diameter, s.look.width_scale) = (0.04, 1.0);
    s.look.real_hairs = lines.len() as f32;
    s.picture.strand_opacity = opacity;
    s
}

fn draw(scene: &Scene, values: &[f32]) -> ValuePicture {
    ValueRenderer::default().picture(&scene.input(), values, SIDE, SIDE).expect("a picture")
}

fn at(picture: &ValuePicture, x: u32, y: u32) -> [f32; 2] {
    let i = (y * picture.width + x) as usize;
    [picture.value[i], picture.weight[i]]
}

#[test]
fn values_vary_along_a_strand_and_are_none_beside_it() {
    let scene = wide(&[upright(0.0, 0.0)], 1.0);
    for mode in Transparency::ALL {
        let mut scene = wide(&[upright(0.0, 0.0)], 1.0);
        scene.picture.transparency = mode;
        let picture = draw(&scene, &(0..11).map(|i| i as f32 - 20.0).collect::<Vec<_>>());
        assert_eq!((picture.value.len(), picture.weight.len()), (64 * 64, 64 * 64));
        for y in 26..38 {
            let [value, weight] = at(&picture, 32, y);
            // The position of the pixel centre on the strand, which is a metre away and 10 cm long.
            let scale = 64.0 * 0.5 / 0.25_f32.tan();
            let expected = 5.0 + (y as f32 + 0.5 - 32.0) / scale * 100.0 - 20.0;
            assert!((value - expected).abs() < 1e-2, "{mode}: {value} for {expected}");
            assert!(weight > 0.6, "{mode}: {weight}");
        }
        let [value, weight] = at(&picture, 2, 32);
        assert!(value.is_nan() && weight == 0.0, "{mode}");
    }
    // Control: reversed values differ.
    let reversed = draw(&scene, &(0..11).map(|i| -(i as f32)).collect::<Vec<_>>());
    assert!((at(&reversed, 32, 30)[0] + 3.8).abs() < 1e-2);
}

#[test]
fn layers_weigh_what_they_cover() {
    let values = [vec![1.0; 11], vec![4.0; 11]].concat();
    // The first strand is in front of the second; streaks of wide strands differ only in phase.
    let value = |opacity, mode| {
        let mut scene = wide(&[upright(0.0, 0.1), upright(0.0, -0.1)], opacity);
        scene.picture.transparency = mode;
        let picture = draw(&scene, &values);
        at(&picture, 32, 32)
    };
    for mode in [Transparency::Sorted, Transparency::Exact] {
        let [front, weight] = value(1.0, mode);
        let alpha = weight;
        assert!((1.0..1.5).contains(&front) && alpha > 0.8, "{mode}: {front} {weight}");
        // Two layers of opacity a: (1 + 4 (1 - a)) / (2 - a). Streaks change a by up to a fifth.
        let [both, weight] = value(0.5, mode);
        let low = |a: f32| (1.0 + 4.0 * (1.0 - a)) / (2.0 - a);
        assert!((low(0.6)..low(0.4)).contains(&both), "{mode}: {both}");
        assert!((0.6..0.9).contains(&weight), "{mode}: {weight}");
    }
    // Control: without an order both have the same weight.
    let [both, _] = value(0.5, Transparency::WeightedAverage);
    assert!((2.2..2.8).contains(&both), "{both}");
}

#[test]
fn pixels_with_hair_are_those_of_the_picture() {
    let mut scene = tuft_scene(60);
    // The shadow of hair on the ground falls where there is no hair.
    scene.picture.ground = false;
    scene.body = None;
    scene.picture.background_top = Vec3::splat(0.8);
    scene.picture.background_bottom = scene.picture.background_top;
    let differing = |shown: &Scene, values: &Scene| {
        let picture = shown.draw_by(BACKEND, SIDE, SIDE).expect("the processor");
        let mut without = common::scene(&[]);
        without.picture = shown.picture;
        let without = without.draw_by(BACKEND, SIDE, SIDE).expect("the processor");
        let n = values.strands.points();
        let values = draw(values, &vec![0.5; n]);
        let (mut differing, mut covered) = (0, 0);
        for y in 0..SIDE {
            for x in 0..SIDE {
                let [value, weight] = at(&values, x, y);
                assert_eq!(value.is_nan(), weight <= 1e-6);
                assert!(value.is_nan() || (value - 0.5).abs() < 1e-4, "{value}");
                let (shown, background) = (pixel(&picture, x, y), pixel(&without, x, y));
                let far = shown.iter().zip(background).any(|(&a, b)| a.abs_diff(b) > 3);
                // Hair that covers a thousandth of a pixel is not visible; a tenth is.
                differing += u32::from((weight > 0.1 && !far) || (weight < 1e-3 && far));
                covered += u32::from(weight > 0.1);
            }
        }
        assert!(covered > 200, "{covered}");
        differing
    };
    assert_eq!(differing(&scene, &scene), 0);
    let mut other = tuft_scene(60);
    other.picture = scene.picture;
    (other.body, other.strands.x) = (None, scene.strands.x.iter().map(|x| x + 0.01).collect());
    assert!(differing(&scene, &other) > 20, "the control: hair beside its place");
}

#[test]
fn the_body_hides_values_behind_it() {
    let drawn = |z: f32| {
        let mut scene = wide(&[upright(0.0, z)], 1.0);
        scene.body = Some(quad(0.0, 0.2, Vec3::ONE));
        at(&draw(&scene, &[2.0; 11]), 32, 32)
    };
    assert!(drawn(-0.1)[0].is_nan() && drawn(-0.1)[1] == 0.0);
    assert!((drawn(0.1)[0] - 2.0).abs() < 1e-5 && drawn(0.1)[1] > 0.6);
}

#[test]
fn what_is_no_value_hides_and_counts_for_nothing() {
    let behind_and_before = [upright(0.0, 0.1), upright(0.0, -0.1)];
    for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX] {
        for mode in Transparency::ALL {
            let mut scene = wide(&behind_and_before, 0.5);
            scene.picture.transparency = mode;
            let picture = draw(&scene, &[vec![odd; 11], vec![3.0; 11]].concat());
            let [value, weight] = at(&picture, 32, 32);
            // With opaque strands a hash decides which of the two a pixel shows.
            assert!((value - 3.0).abs() < 1e-4 || mode == Transparency::Opaque, "{mode}: {value}");
            let all = draw(&scene, &[1.0; 22]);
            assert!((weight - at(&all, 32, 32)[1]).abs() < 1e-5, "{mode}: {weight}");
        }
    }
    let scene = wide(&behind_and_before, 0.5);
    assert!(draw(&scene, &[f32::NAN; 22]).value.iter().all(|value| value.is_nan()));
    let mut renderer = ValueRenderer::default();
    for (values, side) in [(vec![1.0; 21], SIDE), (vec![], SIDE), (vec![1.0; 22], 0)] {
        assert!(renderer.picture(&scene.input(), &values, side, side).is_err());
    }
    let wrong = renderer.picture(&scene.input(), &[1.0], SIDE, SIDE);
    assert!(matches!(wrong, Err(RenderError::Known { found: 1, needed: 22, .. })));
    let nothing = common::scene(&[]);
    let picture = renderer.picture(&nothing.input(), &[], SIDE, SIDE).expect("a picture");
    assert!(picture.value.iter().all(|value| value.is_nan()) && picture.weight.iter().all(|w| *w == 0.0));
}

/// The pixel of a position in an image of `width` by `height` pixels.
fn place_of(input: &FrameInput, p: Vec3, [width, height]: [u32; 2]) -> [f32; 2] {
    let clip = input.camera.clip_from_world(width as f32 / height as f32) * p.extend(1.0);
    let at = clip / clip.w;
    [(0.5 + 0.5 * at.x) * width as f32, (0.5 - 0.5 * at.y) * height as f32]
}

#[test]
fn the_foremost_strand_is_picked() {
    let thin = |lines: &[Vec<Vec3>]| {
        let mut s = scene(lines);
        (s.look.diameter, s.look.width_scale) = (0.003, 1.0);
        s
    };
    let size = [200, 150];
    let pick =
        |scene: &Scene, at: [f32; 2]| ValueRenderer::default().pick(&scene.input(), size[0], size[1], at);
    let scene = thin(&[upright(0.0, -0.1), upright(0.0, 0.1), upright(0.04, 0.0)]);
    for point in 11..33 {
        // Half a pixel beside it.
        let place = place_of(&scene.input(), scene.strands.point(point), size);
        let hit = pick(&scene, [place[0] + 0.4, place[1]]);
        let position = scene.strands.point(point);
        assert_eq!(hit, Some(HairHit { strand: point / 11, point, position }));
    }
    // The first one lies behind the second; the control is without that.
    let behind = place_of(&scene.input(), scene.strands.point(5), size);
    assert_eq!(pick(&scene, behind).map(|hit| hit.strand), Some(1));
    let alone = thin(&[upright(0.0, -0.1)]);
    assert_eq!(pick(&alone, behind).map(|hit| (hit.strand, hit.point)), Some((0, 5)));
    // A position slightly beside a strand finds it, far beside does not.
    let edge = behind[0] + 0.5 * 0.003 / 1.1 * 150.0 * 0.5 / 0.25_f32.tan();
    assert!(pick(&alone, [edge + 3.5, behind[1]]).is_some());
    for (x, y) in [(edge + 4.5, behind[1]), (5.0, 5.0), (-1.0, 3.0), (3.0, 150.0), (f32::NAN, 3.0)] {
        assert_eq!(pick(&alone, [x, y]), None, "{x} {y}");
    }
    assert_eq!(ValueRenderer::default().pick(&alone.input(), 0, 9, behind), None);
}

#[test]
fn hair_behind_the_body_is_not_picked() {
    let pick = |z: f32| {
        let mut s = wide(&[upright(0.0, z)], 1.0);
        s.body = Some(quad(0.0, 0.2, Vec3::ONE));
        ValueRenderer::default().pick(&s.input(), SIDE, SIDE, [32.0, 32.0])
    };
    assert_eq!(pick(-0.1), None);
    assert_eq!(pick(0.1).map(|hit| hit.point), Some(5));
}
