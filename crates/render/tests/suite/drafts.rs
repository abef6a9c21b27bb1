//! Drafts: images that a better one follows soon.

use crate::common;

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use common::{Scene, soft_wig, tuft_scene};
use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_render::{
    CpuRenderer, FrameInput, FrameStats, Interrupt, Picture, RenderError, ShadowMethod, Transparency,
};
use lovelock_testkit::flip;

const SIDE: u32 = 256;
/// Pixels along each edge of a tile.
const TILE: u32 = 32;

fn drawn(renderer: &mut CpuRenderer, scene: &Scene, is_draft: bool) -> (Picture, FrameStats) {
    let mut picture = Picture::default();
    let input = FrameInput { is_draft, ..scene.input() };
    let stats = renderer.picture(&input, SIDE, SIDE, &mut picture).expect("a picture");
    (picture, stats)
}

#[test]
fn fewer_strands_cast_the_shadows_of_a_draft_of_much_hair() {
    // 164,000 points, of which a draft takes half.
    let mut scene = tuft_scene(4000);
    scene.shadow.method = ShadowMethod::VoxelMap;
    let mut renderer = CpuRenderer::default();
    let mut found = |scene: &Scene, is_draft: bool| {
        let (picture, stats) = drawn(&mut renderer, scene, is_draft);
        let is_kept = stats.kept.iter().any(|pass| pass.name == "shadow/build");
        (renderer.transmittance(0).expect("a light"), picture, is_kept)
    };
    let (draft, ..) = found(&scene, true);
    let (exact, picture, is_kept) = found(&scene, false);
    assert!(!is_kept, "the map of a draft serves no better image");
    assert!(picture == drawn(&mut CpuRenderer::default(), &scene, false).0);
    let (finer, _, is_kept) = found(&scene, true);
    assert!(is_kept && finer == exact, "a map of all strands serves a draft");
    // Control: every strand stands for itself alone.
    scene.look.extinction_scale *= 0.5;
    let (control, ..) = found(&scene, true);
    let off = |other: &[f32]| {
        let sum: f32 = exact.iter().zip(other).map(|(a, b)| (a - b).abs()).sum();
        sum / exact.len() as f32
    };
    println!("off by {}, control {}", off(&draft), off(&control));
    assert!(off(&draft) > 0.0 && off(&draft) < 0.4 * off(&control));
}

/// Hair of which a lock is moved, and its strands at rest.
struct Combed {
    scene: Scene,
    rest: Strands,
}

impl Combed {
    fn new() -> Self {
        let scene = soft_wig();
        Self { rest: scene.strands.clone(), scene }
    }

    /// Moves the lock nearest to the camera, from where it rests.
    fn comb(&mut self, metres: f32) {
        let (rest, eye) = (&self.rest, self.scene.camera.eye);
        let points = || (0..rest.points()).map(move |i| rest.point(i));
        let nearest = points().min_by(|a, b| a.distance(eye).total_cmp(&b.distance(eye))).expect("hair");
        let way = (nearest - self.scene.camera.target).with_y(0.5).normalize_or_zero() * metres;
        self.scene.strands = rest.clone();
        let Strands { x, y, z, .. } = &mut self.scene.strands;
        for (i, _) in points().enumerate().filter(|(_, p)| p.distance(nearest) < 0.02) {
            (x[i], y[i], z[i]) = (x[i] + way.x, y[i] + way.y, z[i] + way.z);
        }
    }

    /// The draft of a renderer that draws nothing else.
    fn anew(&self) -> Picture {
        drawn(&mut CpuRenderer::default(), &self.scene, true).0
    }
}

/// The tiles in which two images differ.
fn other_tiles(a: &Picture, b: &Picture) -> Vec<u32> {
    let columns = SIDE / TILE;
    let pixels = a.rgba.as_chunks::<4>().0.iter().zip(b.rgba.as_chunks::<4>().0);
    let mut tiles: Vec<u32> = (0..)
        .zip(pixels)
        .filter(|(_, (a, b))| a != b)
        .map(|(i, _)| i / SIDE / TILE * columns + i % SIDE / TILE)
        .collect();
    tiles.sort_unstable();
    tiles.dedup();
    tiles
}

#[test]
fn what_moves_is_drawn_first_and_the_rest_after_it() {
    let mut hair = Combed::new();
    let mut renderer = CpuRenderer::default();
    renderer.set_hurrying(true);
    let (before, stats) = drawn(&mut renderer, &hair.scene, true);
    assert_eq!(stats.redrawn, None, "the first image is whole");
    hair.comb(0.02);
    let (hurried, stats) = drawn(&mut renderer, &hair.scene, true);
    let tiles = stats.redrawn.expect("a part of the image") * (SIDE / TILE).pow(2) as f32;
    let moved = other_tiles(&before, &hurried);
    println!("{tiles} tiles are drawn, of which {} differ", moved.len());
    assert!(!moved.is_empty() && moved.len() as f32 <= tiles + 0.01, "nothing changes beside them");
    // Control: shadows do in a whole image.
    let whole = hair.anew();
    let all = other_tiles(&before, &whole);
    assert!(all.iter().any(|tile| !moved.contains(tile)), "{all:?} {moved:?}");
    let [near, control] = [&hurried, &before].map(|image| flip(&whole.rgba, &image.rgba, SIDE, SIDE).mean);
    println!("{near} from the whole image, and the one before {control}");
    // Measured: 0.75 of it. The rest are shadows, which are late.
    assert!(near < 0.85 * control, "{near} {control}");
    // Another one over it.
    hair.comb(0.01);
    assert!(drawn(&mut renderer, &hair.scene, true).1.redrawn.is_some());
    renderer.set_hurrying(false);
    let (after, stats) = drawn(&mut renderer, &hair.scene, true);
    assert_eq!(stats.redrawn, None);
    assert!(stats.passes.iter().any(|pass| pass.name == "shadow/build"), "shadows are late no longer");
    assert!(after == hair.anew(), "nothing of what was drawn first is left");
    let best = drawn(&mut CpuRenderer::default(), &hair.scene, false).0;
    assert!(drawn(&mut renderer, &hair.scene, false).0 == best);
}

#[test]
fn an_image_in_which_more_than_hair_has_changed_is_drawn_whole() {
    type Change = (&'static str, fn(&mut Scene));
    let mut hair = Combed::new();
    let mut renderer = CpuRenderer::default();
    renderer.set_hurrying(true);
    drawn(&mut renderer, &hair.scene, true);
    let changes: [Change; 8] = [
        ("the camera", |scene| scene.camera.eye.x += 0.01),
        ("exposure", |scene| scene.picture.exposure_stops += 0.2),
        ("colour", |scene| scene.look.roughness += 0.1),
        ("extinction", |scene| scene.look.extinction_scale *= 1.5),
        ("a light", |scene| scene.lights[0].intensity *= 0.7),
        ("transparency", |scene| scene.picture.transparency = Transparency::Opaque),
        ("the hairstyle", |scene| {
            let style = Arc::make_mut(&mut scene.style);
            style.strands.taper.iter_mut().for_each(|taper| *taper *= 0.7);
        }),
        ("the body", |scene| {
            let (body, mut skin) = scene.body.take().expect("a body");
            skin.positions.iter_mut().for_each(|p| *p += Vec3::new(0.0, 0.01, 0.0));
            scene.body = Some((body, skin));
        }),
    ];
    for (name, change) in changes {
        change(&mut hair.scene);
        hair.comb(0.02);
        let (picture, stats) = drawn(&mut renderer, &hair.scene, true);
        assert_eq!(stats.redrawn, None, "{name}");
        assert!(picture == hair.anew(), "{name}");
        // Control: hair alone, of a hairstyle that is loaded again.
        hair.scene.style = Arc::new((*hair.scene.style).clone());
        hair.comb(0.01);
        assert!(drawn(&mut renderer, &hair.scene, true).1.redrawn.is_some(), "{name}");
    }
    // All that there is, and nothing.
    hair.scene.body = None;
    drawn(&mut renderer, &hair.scene, true);
    for metres in [0.01, 0.0] {
        for y in &mut hair.scene.strands.y {
            *y += metres;
        }
        let (picture, stats) = drawn(&mut renderer, &hair.scene, true);
        assert!(stats.redrawn.is_none() && picture == hair.anew(), "{metres}");
    }
}

#[test]
fn an_image_whose_rest_is_given_up_is_drawn_over() {
    let mut hair = Combed::new();
    let mut renderer = CpuRenderer::default();
    let draw = |renderer: &mut CpuRenderer, hair: &Combed, hurries: bool, ends_after: Option<u32>| {
        renderer.set_hurrying(hurries);
        renderer.set_interrupt(ends_after.map(|most| {
            let asked = AtomicU32::new(0);
            Interrupt::new(move || asked.fetch_add(1, Ordering::Relaxed) >= most)
        }));
        let mut picture = Picture::default();
        let input = FrameInput { is_draft: true, ..hair.scene.input() };
        let stats = renderer.picture(&input, SIDE, SIDE, &mut picture);
        renderer.set_interrupt(None);
        stats.map(|stats| (picture, stats.redrawn.is_some()))
    };
    let is_ended = |drawn: Result<_, RenderError>| matches!(drawn, Err(RenderError::Interrupted));
    draw(&mut renderer, &hair, false, None).expect("an image");
    // Before anything, between stages, and between tiles.
    for ends_after in [0, 1, 2, 3, 4, 20] {
        hair.comb(0.02);
        let (_, is_part) = draw(&mut renderer, &hair, true, Some(1)).expect("it is not asked for");
        assert!(is_part, "{ends_after}");
        assert!(is_ended(draw(&mut renderer, &hair, false, Some(ends_after))), "{ends_after}");
        hair.comb(0.01);
        let (_, is_part) = draw(&mut renderer, &hair, true, None).expect("an image");
        assert!(is_part, "{ends_after}");
        let (whole, _) = draw(&mut renderer, &hair, false, None).expect("an image");
        assert!(whole == hair.anew(), "{ends_after}");
    }
    // Control: over some tiles of other hair nothing can be drawn.
    hair.comb(0.02);
    assert!(is_ended(draw(&mut renderer, &hair, false, Some(20))));
    hair.comb(0.01);
    let (whole, is_part) = draw(&mut renderer, &hair, true, None).expect("an image");
    assert!(!is_part && whole == hair.anew());
}
