//! Pictures of tiny scenes by the CPU backend; no adapter is needed.

#[allow(clippy::duplicate_mod, reason = "the same cases for each backend")]
#[path = "../cases/mod.rs"]
mod cases;

use lovelock_render::Backend;

const BACKEND: Backend = Backend::Cpu;

use std::sync::Arc;

use glam::Vec3;
use lovelock_render::{CpuRenderer, FrameStats, Light, LightKind, Picture, ShadowMethod};

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
    // What changes, and whether the depth maps of the body and the shadows of hair are kept.
    let changes: [(&str, Change, [bool; 2]); 16] = [
        ("the first picture", |_| {}, [false, false]),
        ("nothing", |_| {}, [true, true]),
        ("the camera", |scene| scene.camera.eye.x += 0.1, [true, true]),
        ("exposure", |scene| scene.picture.exposure_stops += 0.5, [true, true]),
        ("colour", |scene| scene.look.roughness += 0.1, [true, true]),
        ("extinction", |scene| scene.look.extinction_scale *= 2.0, [true, false]),
        ("hair", |scene| scene.strands.y.iter_mut().for_each(|y| *y -= 0.01), [true, false]),
        ("the method", |scene| scene.shadow.method = ShadowMethod::OpacityMaps, [true, false]),
        ("brightness of a light", |scene| scene.lights[0].intensity *= 0.7, [true, true]),
        ("another light", |scene| scene.lights.push(Light::default()), [false, false]),
        ("a light turns", |scene| scene.lights[0].direction.x += 0.3, [false, false]),
        (
            "a lamp",
            |scene| {
                scene.lights[0].kind = LightKind::Spot;
                scene.lights[0].stand_before(Vec3::ZERO, 0.7);
            },
            [false, false],
        ),
        ("a lamp moves", |scene| scene.lights[0].position.x += 0.1, [false, false]),
        ("a softer cone", |scene| scene.lights[0].inner_angle *= 0.05, [true, true]),
        ("a narrower cone", |scene| scene.lights[0].outer_angle *= 0.4, [false, false]),
        (
            "the body",
            |scene| {
                let (body, skin) = scene.body.take().expect("a body");
                let mut moved = skin.clone();
                moved.positions.iter_mut().for_each(|p| p.y += 0.02);
                scene.body = Some((Arc::clone(&body), moved));
            },
            [false, false],
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
        names
    };
    let mut passes = None;
    let mut before = Picture::default();
    for (name, change, [body, hair]) in changes {
        change(&mut scene);
        let ((kept, stats), (computed, _)) = (draw(&mut keeping, &scene), draw(&mut plain, &scene));
        assert!(kept == computed, "{name}");
        assert!(name == "nothing" || kept != before, "control: {name} is seen");
        let builds = |stats: &FrameStats| stats.passes.iter().any(|pass| pass.name == "shadow/build");
        assert_eq!(
            (stats.passes.iter().any(|pass| pass.name == "draw/body-depth"), builds(&stats)),
            (!body, !hair),
            "{name}"
        );
        let whole = stats.made_anew();
        assert_eq!(all(&stats), all(&whole), "{name}");
        assert_eq!(passes.get_or_insert_with(|| all(&stats)), &all(&stats), "{name}");
        let is_kept = stats.kept.iter().any(|pass| pass.name == "interpolate");
        assert_eq!(is_kept, hair, "{name}: the time of interpolated strands");
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
