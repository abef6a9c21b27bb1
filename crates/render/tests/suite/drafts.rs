//! Drafts: images that a better one follows soon.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_render::{
    BackgroundForm, CarriedHair, ColorScale, CpuRenderer, FrameInput, FrameStats, Interrupt, Layers, Light,
    Picture, RenderError, ShadowMethod, Transparency, VoxelDeposit,
};
use lovelock_testkit::flip;

use super::backdrop::grey;
use crate::common::{Scene, one_strand, panorama, scene, soft_wig, tuft_scene};

const SIDE: u32 = 256;
/// Pixels along each edge of a tile.
const TILE: u32 = 32;

fn drawn(renderer: &mut CpuRenderer, input: &FrameInput) -> (Picture, FrameStats) {
    let mut picture = Picture::default();
    let stats = renderer.picture(input, SIDE, SIDE, &mut picture).expect("a picture");
    (picture, stats)
}

/// Whether the shadow maps of an image are those of the one before.
fn keeps_maps(stats: &FrameStats) -> bool {
    stats.kept.iter().any(|pass| pass.name == "shadow/build")
}

#[test]
fn fewer_strands_cast_the_shadows_of_a_draft_of_much_hair() {
    // 164,000 points, of which a draft takes half.
    let mut scene = tuft_scene(4000);
    scene.shadow.method = ShadowMethod::VoxelMap;
    let mut renderer = CpuRenderer::default();
    let mut found = |is_draft: bool| {
        let (picture, stats) = drawn(&mut renderer, &FrameInput { is_draft, ..scene.input() });
        (renderer.transmittance(0).expect("a light"), picture, keeps_maps(&stats))
    };
    let (draft, ..) = found(true);
    let (exact, picture, is_kept) = found(false);
    assert!(!is_kept && draft != exact, "the map of a draft serves no better image");
    assert!(picture == drawn(&mut CpuRenderer::default(), &scene.input()).0);
    let (finer, _, is_kept) = found(true);
    assert!(is_kept && finer == exact, "a map of all strands serves a draft");
}

/// The mean light of hair where it is seen, linear, and whether its shadow maps are those of the image before.
fn light_of_hair(renderer: &mut CpuRenderer, scene: &Scene, is_draft: bool) -> (f64, bool) {
    let mut layers = Layers::default();
    let input = FrameInput { is_draft, ..scene.input() };
    let stats = renderer.light(&input, 64, 64, false, &mut layers).expect("an image");
    let sum = |of: fn(&[f32; 4]) -> f32| layers.light.iter().map(|pixel| f64::from(of(pixel))).sum::<f64>();
    (sum(|[r, g, b, _]| r + g + b) / sum(|pixel| pixel[3]), keeps_maps(&stats))
}

/// Hair of 131,200 points, of whose strands a draft may take half as casters.
fn much_hair() -> Scene {
    let mut scene = tuft_scene(3200);
    scene.body = None;
    scene.picture.ground = false;
    // Light that hair does not block would hide a part of the difference.
    scene.picture.ambient = 0.0;
    scene.lights = vec![Light { direction: Vec3::new(-1.0, -0.3, -0.2), ..Light::default() }];
    scene.shadow.ray_traced.rays = 1;
    // About as dark as by length.
    scene.shadow.voxel_map.point_extinction = 200.0;
    scene
}

#[test]
fn a_draft_of_much_hair_is_as_bright_as_a_whole_image() {
    // Along the light, 15 strands of a depth of 0.06 lie behind each other in a texel. Half of them, twice as dark, have the same depth in
    // the mean, with a variance of 15 · 0.06². Half of that, 3 %, is what they let through in addition, behind all hair; before all hair
    // it is nothing. Without the weight the depth is half of 0.9, and the mean light 20 % more.
    const MOST: f64 = 0.05;
    let mut scene = much_hair();
    let sums = ShadowMethod::ALL.iter().filter(|method| method.sums_strands());
    let by_length = sums.map(|&method| (method, VoxelDeposit::Length));
    for (method, deposit) in by_length.chain([(ShadowMethod::VoxelMap, VoxelDeposit::PointCount)]) {
        (scene.shadow.method, scene.shadow.voxel_map.deposit) = (method, deposit);
        let mut renderer = CpuRenderer::default();
        let (draft, _) = light_of_hair(&mut renderer, &scene, true);
        let (whole, is_kept) = light_of_hair(&mut renderer, &scene, false);
        assert!(!is_kept, "{method}");
        // Control: each strand stands for itself alone.
        scene.look.extinction_scale *= 0.5;
        let (control, _) = light_of_hair(&mut renderer, &scene, true);
        scene.look.extinction_scale *= 2.0;
        let [off, control] = [draft, control].map(|light| (light / whole - 1.0).abs());
        println!("{method}, {deposit:?}: off by {off}, control {control}");
        assert!(off < MOST && control > MOST, "{method}, {deposit:?}: {off} {control}");
    }
}

#[test]
fn methods_that_do_not_add_strands_up_have_all_of_them_in_a_draft() {
    let mut scene = much_hair();
    for &method in ShadowMethod::ALL.iter().filter(|method| !method.sums_strands()) {
        scene.shadow.method = method;
        let mut renderer = CpuRenderer::default();
        let (draft, _) = light_of_hair(&mut renderer, &scene, true);
        let (whole, is_kept) = light_of_hair(&mut renderer, &scene, false);
        assert!(is_kept, "{method}");
        assert_eq!(draft, whole, "{method}");
    }
}

/// Hair of which a lock is moved, and its strands at rest.
struct Combed {
    scene: Scene,
    rest: Strands,
    /// Hair that the skin carries.
    brow: Option<Scene>,
}

impl Combed {
    fn new() -> Self {
        let scene = soft_wig();
        Self { rest: scene.strands.clone(), scene, brow: None }
    }

    /// That of a draft.
    fn input(&self) -> FrameInput<'_> {
        let carried = self.brow.as_ref().map(|brow| CarriedHair {
            style: &brow.style,
            strands: &brow.strands,
            look: brow.look,
        });
        FrameInput { is_draft: true, carried, ..self.scene.input() }
    }

    fn draft(&self, renderer: &mut CpuRenderer) -> (Picture, FrameStats) {
        drawn(renderer, &self.input())
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
        self.draft(&mut CpuRenderer::default()).0
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
    let (before, stats) = hair.draft(&mut renderer);
    assert_eq!(stats.redrawn, None, "the first image is whole");
    hair.comb(0.02);
    let (hurried, stats) = hair.draft(&mut renderer);
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
    assert!(hair.draft(&mut renderer).1.redrawn.is_some());
    renderer.set_hurrying(false);
    let (after, stats) = hair.draft(&mut renderer);
    assert_eq!(stats.redrawn, None);
    assert!(stats.passes.iter().any(|pass| pass.name == "shadow/build"), "shadows are late no longer");
    assert!(after == hair.anew(), "nothing of what was drawn first is left");
    let full = FrameInput { is_draft: false, ..hair.input() };
    assert!(drawn(&mut renderer, &full).0 == drawn(&mut CpuRenderer::default(), &full).0);
}

/// A change of more than hair.
type Change = (&'static str, fn(&mut Combed));

/// Whether it was tried to draw an image over the one before.
fn is_tried(stats: &FrameStats) -> bool {
    stats.passes.iter().any(|pass| pass.name == "draw/moved")
}

/// Draws a draft after each change, which must be whole, and one after hair alone has moved, which must not.
fn expect_whole(renderer: &mut CpuRenderer, hair: &mut Combed, changes: &[Change]) {
    for (name, change) in changes {
        change(hair);
        hair.comb(0.02);
        let (picture, stats) = hair.draft(renderer);
        assert_eq!(stats.redrawn, None, "{name}");
        assert!(picture == hair.anew(), "{name}");
        if hair.scene.picture.transparency != Transparency::Sorted {
            // All points are shaded first, which must not be done twice.
            hair.comb(0.015);
            let (_, stats) = hair.draft(renderer);
            assert!(stats.redrawn.is_none() && !is_tried(&stats), "{name}");
            hair.scene.picture.transparency = Transparency::Sorted;
            hair.draft(renderer);
        }
        // Control: hair alone, of a hairstyle that is loaded again.
        hair.scene.style = Arc::new((*hair.scene.style).clone());
        hair.comb(0.01);
        assert!(hair.draft(renderer).1.redrawn.is_some(), "{name}");
    }
}

/// A renderer that hurries, and its first draft.
fn hurrying(hair: &Combed) -> CpuRenderer {
    let mut renderer = CpuRenderer::default();
    renderer.set_hurrying(true);
    hair.draft(&mut renderer);
    renderer
}

#[test]
fn an_image_in_which_more_than_hair_has_changed_is_drawn_whole() {
    let mut hair = Combed::new();
    let mut renderer = hurrying(&hair);
    let changes: [Change; 8] = [
        ("the camera", |hair| hair.scene.camera.eye.x += 0.01),
        ("exposure", |hair| hair.scene.picture.exposure_stops += 0.2),
        ("colour", |hair| hair.scene.look.roughness += 0.1),
        ("extinction", |hair| hair.scene.look.extinction_scale *= 1.5),
        ("a light", |hair| hair.scene.lights[0].intensity *= 0.7),
        ("transparency", |hair| hair.scene.picture.transparency = Transparency::Opaque),
        ("the hairstyle", |hair| {
            let style = Arc::make_mut(&mut hair.scene.style);
            style.strands.taper.iter_mut().for_each(|taper| *taper *= 0.7);
        }),
        ("the body", |hair| {
            let (body, mut skin) = hair.scene.body.take().expect("a body");
            skin.positions.iter_mut().for_each(|p| *p += Vec3::new(0.0, 0.01, 0.0));
            hair.scene.body = Some((body, skin));
        }),
    ];
    expect_whole(&mut renderer, &mut hair, &changes);
    // All that there is, and nothing.
    hair.scene.body = None;
    hair.draft(&mut renderer);
    for metres in [0.01, 0.0] {
        for y in &mut hair.scene.strands.y {
            *y += metres;
        }
        let (picture, stats) = hair.draft(&mut renderer);
        assert!(stats.redrawn.is_none() && picture == hair.anew(), "{metres}");
        assert_eq!(is_tried(&stats), metres > 0.0, "its time is listed");
    }
}

#[test]
fn an_image_with_other_things_around_its_hair_is_drawn_whole() {
    let mut hair = Combed::new();
    hair.scene.picture.background = BackgroundForm::Picture;
    let mut renderer = hurrying(&hair);
    let sky =
        |hair: &mut Combed| hair.scene.surroundings = Some(panorama(|row, _| Vec3::splat(0.02 * row as f32)));
    let changes: [Change; 7] = [
        ("surroundings", sky),
        ("surroundings that are loaded again", sky),
        ("a picture behind", |hair| hair.scene.backdrop = grey(60)),
        ("another picture behind", |hair| hair.scene.backdrop = grey(120)),
        ("a brow", |hair| hair.brow = Some(scene(&one_strand()))),
        ("its look", |hair| hair.brow.as_mut().expect("a brow").look.diameter *= 2.0),
        ("its style", |hair| {
            let style = Arc::make_mut(&mut hair.brow.as_mut().expect("a brow").style);
            style.strands.taper.iter_mut().for_each(|taper| *taper *= 0.7);
        }),
    ];
    expect_whole(&mut renderer, &mut hair, &changes);
}

#[test]
fn nothing_is_drawn_over_an_image_of_another_kind() {
    type Draw = (&'static str, fn(&mut CpuRenderer, &FrameInput) -> FrameStats);
    let mut hair = Combed::new();
    let mut renderer = hurrying(&hair);
    let kinds: [Draw; 4] = [
        ("no draft", |renderer, input| drawn(renderer, &FrameInput { is_draft: false, ..*input }).1),
        ("strand colours", |renderer, input| {
            let values = vec![0.5_f32; input.style.strands.count()];
            let colors = std::array::from_fn(|k| [k as u8; 3]);
            let scale = ColorScale { range: [0.0, 1.0], colors, behind: 0.3, saturation: 0.0, relief: 0.0 };
            let mut picture = Picture::default();
            renderer.strand_colors(input, [SIDE; 2], (&values, &scale), &mut picture).expect("an image")
        }),
        ("layers", |renderer, input| {
            renderer.layers(input, SIDE, SIDE, true, &mut Layers::default()).expect("layers")
        }),
        ("another size", |renderer, input| {
            renderer.picture(input, SIDE, SIDE / 2, &mut Picture::default()).expect("an image")
        }),
    ];
    for (name, draw) in kinds {
        hair.comb(0.02);
        assert_eq!(draw(&mut renderer, &hair.input()).redrawn, None, "{name}");
        hair.comb(0.01);
        let (picture, stats) = hair.draft(&mut renderer);
        assert_eq!(stats.redrawn, None, "a draft after {name}");
        assert!(picture == hair.anew(), "{name}");
        // Control: a draft after a draft.
        hair.comb(0.015);
        assert!(hair.draft(&mut renderer).1.redrawn.is_some(), "{name}");
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
        let stats = renderer.picture(&hair.input(), SIDE, SIDE, &mut picture);
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
