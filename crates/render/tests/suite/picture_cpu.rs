//! Pictures of tiny scenes by the CPU backend; no adapter is needed.

#[allow(clippy::duplicate_mod, reason = "the same cases for each backend")]
#[path = "../cases/mod.rs"]
mod cases;

use lovelock_render::Backend;

const BACKEND: Backend = Backend::Cpu;

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use lovelock_render::{
    CpuRenderer, FrameStats, Interrupt, Light, LightKind, Picture, RenderError, ShadowMethod,
};

use crate::common::{Scene, grid, scene, soft_wig, tuft};

/// A change of a scene.
type Change = fn(&mut Scene);

#[test]
fn what_is_kept_from_picture_to_picture_changes_no_byte() {
    let mut scene = scene(&tuft(60));
    scene.body = Some(grid(-0.1, 0.3, 8, Vec3::new(0.5, 0.3, 0.2)));
    scene.picture.ground = true;
    scene.shadow.method = ShadowMethod::VoxelMap;
    keeps(scene);
}

#[test]
fn what_is_kept_of_fine_strands_changes_no_byte() {
    keeps(soft_wig());
}

fn keeps(mut scene: Scene) {
    let (mut keeping, mut plain) = (CpuRenderer::default(), CpuRenderer::default().keeping_nothing());
    // What changes, and whether all depth maps of the body, all maps of hair, and the strands are kept.
    let changes: [(&str, Change, [bool; 3]); 18] = [
        ("the first picture", |_| {}, [false, false, false]),
        ("nothing", |_| {}, [true, true, true]),
        ("the camera", |scene| scene.camera.eye.x += 0.1, [true, true, true]),
        ("exposure", |scene| scene.picture.exposure_stops += 0.5, [true, true, true]),
        ("colour", |scene| scene.look.roughness += 0.1, [true, true, true]),
        ("extinction", |scene| scene.look.extinction_scale *= 2.0, [true, false, false]),
        ("hair", |scene| scene.strands.y.iter_mut().for_each(|y| *y -= 0.01), [true, false, false]),
        ("the method", |scene| scene.shadow.method = ShadowMethod::OpacityMaps, [true, false, false]),
        ("brightness of a light", |scene| scene.lights[0].intensity *= 0.7, [true, true, true]),
        ("another light", |scene| scene.lights.push(Light::default()), [false, false, true]),
        ("samples of a light", |scene| scene.lights[1].shadow_samples = 4, [true, false, true]),
        ("a larger light", |scene| scene.lights[1].angular_radius = 0.5, [true, false, true]),
        ("a light turns", |scene| scene.lights[0].direction.x += 0.3, [false, false, true]),
        (
            "a lamp",
            |scene| {
                scene.lights[0].kind = LightKind::Spot;
                scene.lights[0].stand_before(Vec3::ZERO, 0.7);
            },
            [false, false, false],
        ),
        ("a lamp moves", |scene| scene.lights[0].position.x += 0.1, [false, false, false]),
        ("a softer cone", |scene| scene.lights[0].inner_angle *= 0.05, [true, true, true]),
        ("a narrower cone", |scene| scene.lights[0].outer_angle *= 0.4, [false, false, true]),
        (
            "the body",
            |scene| {
                let (body, skin) = scene.body.take().expect("a body");
                let mut moved = skin.clone();
                moved.positions.iter_mut().for_each(|p| p.y += 0.02);
                scene.body = Some((Arc::clone(&body), moved));
            },
            [false, true, true],
        ),
    ];
    let draw = |renderer: &mut CpuRenderer, scene: &Scene| {
        let mut picture = Picture::default();
        let stats = renderer.picture(&scene.input(), 96, 72, &mut picture).expect("a picture");
        (picture, stats)
    };
    // Every pass of a picture, whether it was run or kept.
    let all = |stats: &FrameStats| {
        let kept = stats.kept.iter().filter(|pass| pass.name != "interpolate");
        let mut names: Vec<_> = stats.passes.iter().chain(kept).map(|pass| pass.name.clone()).collect();
        names.sort_unstable();
        names.dedup();
        names
    };
    let mut passes = None;
    let mut before = Picture::default();
    for (name, change, [body, maps, strands]) in changes {
        change(&mut scene);
        let ((kept, stats), (computed, _)) = (draw(&mut keeping, &scene), draw(&mut plain, &scene));
        assert!(kept == computed, "{name}");
        assert!(name == "nothing" || kept != before, "control: {name} is seen");
        let builds = |stats: &FrameStats| stats.passes.iter().any(|pass| pass.name == "shadow/build");
        assert_eq!(
            (stats.passes.iter().any(|pass| pass.name == "draw/body-depth"), builds(&stats)),
            (!body, !maps),
            "{name}"
        );
        let whole = stats.made_anew();
        assert_eq!(all(&stats), all(&whole), "{name}");
        assert_eq!(passes.get_or_insert_with(|| all(&stats)), &all(&stats), "{name}");
        let is_kept = stats.kept.iter().any(|pass| pass.name == "interpolate");
        assert_eq!(is_kept, strands, "{name}: the time of interpolated strands");
        let is_map_kept = stats.kept.iter().any(|pass| pass.name == "shadow/build");
        // One of two lights changes, and the map of the other is kept.
        let of_one =
            ["samples of a light", "a larger light", "a light turns", "a narrower cone"].contains(&name);
        assert_eq!(is_map_kept, maps || of_one, "{name}");
        assert!(whole.interpolate_ms >= stats.interpolate_ms, "{name}");
        before = kept;
    }
    // A picture that fails leaves nothing behind.
    (scene.look.diameter, scene.look.real_hairs) = (17e-6, 1.0);
    scene.shadow.exact.resolution = *lovelock_render::TEXEL_RESOLUTIONS.end();
    scene.shadow.exact.memory_limit_bytes = 1;
    scene.shadow.method = ShadowMethod::Exact;
    let mut picture = Picture::default();
    assert!(keeping.picture(&scene.input(), 96, 72, &mut picture).is_err());
    assert!(keeping.picture(&scene.input(), 96, 72, &mut picture).is_err(), "not the shadows of before");
}

#[test]
fn a_picture_that_is_ended_early_leaves_nothing_behind() {
    let mut scene = scene(&tuft(60));
    scene.body = Some(grid(-0.1, 0.3, 8, Vec3::new(0.5, 0.3, 0.2)));
    scene.shadow.method = ShadowMethod::VoxelMap;
    let mut wanted = Picture::default();
    let mut renderer = CpuRenderer::default();
    renderer.picture(&scene.input(), 96, 72, &mut wanted).expect("a picture");
    let mut ended = 0;
    loop {
        // Other hair before, of which nothing must be kept.
        let at_rest = scene.strands.y.clone();
        scene.strands.y.iter_mut().for_each(|y| *y += 0.1);
        let asked = AtomicU32::new(0);
        let interrupt = Interrupt::new(move || asked.fetch_add(1, Ordering::Relaxed) >= ended);
        renderer.set_interrupt(Some(interrupt));
        let mut picture = Picture::default();
        let result = renderer.picture(&scene.input(), 96, 72, &mut picture);
        renderer.set_interrupt(None);
        scene.strands.y = at_rest;
        match result {
            Err(RenderError::Interrupted) => ended += 1,
            Err(error) => panic!("{error}"),
            Ok(_) => {
                assert!(picture != wanted, "control: other hair is seen");
                break;
            }
        }
        renderer.picture(&scene.input(), 96, 72, &mut picture).expect("a picture");
        assert!(picture == wanted, "after {ended} stages and tiles");
    }
    // Four stages and nine tiles, which several threads may ask in any order.
    assert!((6..=13).contains(&ended), "{ended}");
}

#[test]
fn an_image_that_is_given_up_leaves_its_maps_to_the_next_one() {
    let mut scene = scene(&tuft(60));
    scene.body = Some(grid(-0.1, 0.3, 8, Vec3::new(0.5, 0.3, 0.2)));
    let mut renderer = CpuRenderer::default();
    let mut picture = Picture::default();
    // Whether the maps of hair and body are kept by the image after one that was given up between stages.
    let mut kept_after = |scene: &Scene| {
        let asked = AtomicU32::new(0);
        renderer.set_interrupt(Some(Interrupt::new(move || asked.fetch_add(1, Ordering::Relaxed) >= 1)));
        let given_up = renderer.picture(&scene.input(), 96, 72, &mut picture);
        assert!(matches!(given_up, Err(RenderError::Interrupted)));
        renderer.set_interrupt(None);
        let stats = renderer.picture(&scene.input(), 96, 72, &mut picture).expect("a picture");
        ["shadow/build", "draw/body-depth"].map(|name| stats.kept.iter().any(|pass| pass.name == name))
    };
    assert_eq!(kept_after(&scene), [true, true], "made by the image that was given up");
    scene.camera.eye.x += 0.1;
    assert_eq!(kept_after(&scene), [true, true]);
}
