//! Images for a window: textures of its device, without copies to memory and without waiting.

use std::sync::Arc;
use std::time::Duration;

use glam::Vec3;
use lovelock_groom::{Hairstyle, Strands};
use lovelock_render::{
    DeviceImage, DeviceImages, Finished, FrameStats, GpuRenderer, LocalShadow, Picture, RenderError,
    ShadowMethod, Shrinker, Traffic, Transparency,
};
use lovelock_testkit::suite::sample;

use super::cluster_agreement::wig;
use crate::common::{Scene, grid, on_device, scene, tuft};

const SIZE: [u32; 2] = [160, 120];
const PIXEL_BYTES: u64 = 4 * SIZE[0] as u64 * SIZE[1] as u64;
/// Two words of the head and two of padding, for the list of the image and those of four lights.
const HEADS_BYTES: u64 = 5 * 16;

struct Rig {
    renderer: GpuRenderer,
    images: DeviceImages,
}

impl Rig {
    fn new() -> Option<Self> {
        let (renderer, images) = on_device()?;
        Some(Self { renderer, images })
    }

    fn image(&mut self, scene: &Scene) -> (Arc<DeviceImage>, FrameStats) {
        self.renderer.image(&scene.input(), SIZE, false, &mut self.images).expect("an image")
    }

    fn finish(&mut self) -> Option<Finished> {
        loop {
            if let Some(done) = self.renderer.finished().expect("no error") {
                return Some(done);
            }
            if self.renderer.in_flight() == 0 {
                return None;
            }
            self.renderer.wait_for_oldest(Duration::from_millis(50));
        }
    }

    /// Images until the lists are long enough.
    fn settled(&mut self, scene: &Scene) -> Arc<DeviceImage> {
        for _ in 0..8 {
            let (image, _) = self.image(scene);
            if !self.finish().expect("it was in flight").again {
                return image;
            }
        }
        panic!("the lists do not settle");
    }

    fn picture(&mut self, scene: &Scene) -> (Picture, FrameStats) {
        let mut picture = Picture::default();
        let stats = self.renderer.picture(&scene.input(), SIZE[0], SIZE[1], &mut picture).expect("a picture");
        (picture, stats)
    }
}

/// A tuft before a body, with shadows.
fn lit(transparency: Transparency, method: ShadowMethod) -> Scene {
    let mut scene = scene(&tuft(60));
    scene.body = Some(grid(-0.1, 0.3, 8, Vec3::new(0.5, 0.3, 0.2)));
    scene.picture.transparency = transparency;
    scene.picture.ground = true;
    scene.shadow.method = method;
    // Small maps: a software adapter takes most of its time for their texels.
    scene.shadow.voxel_map.resolution = 48;
    scene.shadow.occupancy_maps.resolution = 64;
    scene.shadow.density_clustering.resolution = 64;
    scene
}

/// Moves the hair a little.
fn sway(scene: &mut Scene, step: u32) {
    let by = 0.002 * (step as f32).sin();
    scene.strands.x.iter_mut().for_each(|x| *x += by);
}

#[test]
fn images_stay_on_the_device_and_nothing_waits_or_is_created() {
    let Some(mut rig) = Rig::new() else { return };
    let methods = [ShadowMethod::VoxelMap, ShadowMethod::OccupancyMaps, ShadowMethod::DensityClustering];
    let all = Transparency::ALL.into_iter().flat_map(|of| methods.map(|method| (of, method)));
    // Every transparency and every method is among each second of them.
    for (transparency, method) in sample(all, 2) {
        let mut scene = lit(transparency, method);
        rig.settled(&scene);
        // The textures and bind groups of the first frames.
        for step in 0..6 {
            sway(&mut scene, step);
            rig.image(&scene);
            rig.finish();
        }
        let mut all = Traffic::default();
        for step in 6..10 {
            sway(&mut scene, step);
            let (_, stats) = rig.image(&scene);
            rig.finish();
            let Traffic { bytes_up, bytes_back, waits, created } = stats.traffic;
            all.bytes_up += bytes_up;
            all.bytes_back += bytes_back;
            all.waits += waits;
            all.created += created;
        }
        let named = format!("{transparency}, {method}: {all:?}");
        let has_lists = matches!(transparency, Transparency::Sorted | Transparency::Exact);
        let back = if has_lists { 4 * HEADS_BYTES } else { 0 };
        assert_eq!((all.bytes_back, all.waits, all.created), (back, 0, 0), "{named}");
        // The strands, the body and the grid of light from all directions go up, and little else.
        let moved = 16 * scene.strands.x.len() as u64 + 32 * 81 + 8 * 32 * 32 * 32;
        assert!(all.bytes_up >= 4 * moved && all.bytes_up < 4 * (moved + 8192), "{named}");
        // Control: a picture in memory is waited for and copied.
        let (_, stats) = rig.picture(&scene);
        assert!(stats.traffic.waits > 0 && stats.traffic.bytes_back >= PIXEL_BYTES, "{:?}", stats.traffic);
    }
}

#[test]
fn moments_without_a_distribution_are_told_with_the_finished_image() {
    let Some(mut rig) = Rig::new() else { return };
    let mut scene = lit(Transparency::WeightedAverage, ShadowMethod::Moments);
    scene.shadow.moments.resolution = 64;
    rig.image(&scene);
    assert_eq!(rig.finish().expect("it was in flight").shadow_fallbacks, 0, "control");
    scene.shadow.moments.bias = 0.0;
    rig.image(&scene);
    let told = rig.finish().expect("it was in flight").shadow_fallbacks;
    assert!(told > 0);
    // A picture in memory waits for the count.
    assert_eq!(rig.picture(&scene).1.shadow_fallbacks, told);
}

#[test]
fn clusters_follow_guides_without_further_traffic() {
    let Some(mut rig) = Rig::new() else { return };
    for shadow in [LocalShadow::Map, LocalShadow::Directional] {
        let mut scene = wig();
        scene.shadow.voxel_map.resolution = 48;
        scene.picture.clusters.local_shadow = shadow;
        scene.picture.transparency = Transparency::WeightedAverage;
        let mut all = Traffic::default();
        for step in 0..9 {
            let guides = scene.guides.as_mut().expect("guides");
            guides.guides.x.iter_mut().for_each(|x| *x += 0.002 * (step as f32).sin());
            let (_, stats) = rig.image(&scene);
            rig.finish();
            // The first frames make textures and bind groups.
            if step >= 5 {
                let Traffic { bytes_up, bytes_back, waits, created } = stats.traffic;
                all.bytes_up += bytes_up;
                all.bytes_back += bytes_back;
                all.waits += waits;
                all.created += created;
            }
        }
        assert_eq!((all.bytes_back, all.waits, all.created), (0, 0, 0), "{shadow:?}: {all:?}");
        // The guides, for the strands that cast shadows and for the ribs, the grid of light from all directions, and two uniforms of a
        // frame, which have room for the maps of four lamps.
        let guides = scene.guides.as_ref().map_or(0, |frame| frame.guides.x.len()) as u64;
        assert!(all.bytes_up < 4 * (2 * 12 * guides + 8 * 32 * 32 * 32 + 2 * 8192), "{shadow:?}: {all:?}");
    }
}

#[test]
fn an_image_has_the_bytes_of_the_picture() {
    let Some(mut rig) = Rig::new() else { return };
    for transparency in Transparency::ALL {
        let scene = lit(transparency, ShadowMethod::VoxelMap);
        let image = rig.settled(&scene).read().expect("pixels");
        let (picture, _) = rig.picture(&scene);
        assert!(image == picture, "{transparency}");
        assert!(picture.rgba.chunks_exact(4).any(|pixel| pixel[..3] != picture.rgba[..3]), "control: hair");
    }
}

#[test]
fn an_image_whose_list_was_too_short_shows_the_one_before() {
    for (transparency, method) in
        [(Transparency::Exact, ShadowMethod::None), (Transparency::Opaque, ShadowMethod::Exact)]
    {
        let Some(mut rig) = Rig::new() else { return };
        // Nothing is too short without hair.
        let mut little = lit(transparency, method);
        little.style = Arc::new(Hairstyle::default());
        little.strands = Strands::default();
        let before = rig.settled(&little).read().expect("pixels");
        // Wide strands over the whole picture, before any list has grown.
        let mut much = Scene { body: lit(transparency, method).body, ..scene(&tuft(600)) };
        (much.picture.transparency, much.shadow.method) = (transparency, method);
        much.camera.eye.z = 0.4;
        if method == ShadowMethod::None {
            much.look.diameter = 0.01;
        }
        much.shadow.exact.resolution = 2048;
        let (image, _) = rig.image(&much);
        let done = rig.finish().expect("it was in flight");
        assert!(done.again, "{transparency}, {method}: the lists are too short at first");
        assert!(image.read().expect("pixels") == before, "the image before is shown");
        let image = rig.settled(&much).read().expect("pixels");
        assert!(image == rig.picture(&much).0, "then the whole image");
        assert!(image != before, "control");
    }
}

#[test]
fn frames_are_in_flight_and_finish_in_order() {
    let Some(mut rig) = Rig::new() else { return };
    let scene = lit(Transparency::WeightedAverage, ShadowMethod::VoxelMap);
    rig.settled(&scene);
    let images: Vec<_> = (0..3).map(|_| rig.image(&scene).0).collect();
    assert_eq!(rig.renderer.in_flight(), 3, "nothing was waited for");
    assert!((0..3).all(|k| !Arc::ptr_eq(&images[k], &images[(k + 1) % 3])), "each has its own texture");
    let held = Arc::clone(&images[0]);
    drop(images);
    for _ in 0..3 {
        assert!(rig.finish().is_some_and(|done| done.ms > 0.0 && done.mean_transmittance.is_none()));
    }
    assert_eq!(rig.finish(), None);
    // A texture that somebody holds is not drawn over; those that nobody holds are used again.
    let pixels = held.read().expect("pixels");
    let mut other = lit(Transparency::WeightedAverage, ShadowMethod::VoxelMap);
    other.picture.background_top = Vec3::ONE;
    for _ in 0..6 {
        let (image, stats) = rig.image(&other);
        assert!(!Arc::ptr_eq(&image, &held));
        assert_eq!(stats.traffic.waits, 0);
        rig.finish();
    }
    assert!(held.read().expect("pixels") == pixels);
}

#[test]
fn what_is_measured_is_that_of_the_picture() {
    let Some(mut rig) = Rig::new() else { return };
    let scene = lit(Transparency::Sorted, ShadowMethod::VoxelMap);
    rig.settled(&scene);
    let (_, stats) = rig.renderer.image(&scene.input(), SIZE, true, &mut rig.images).expect("an image");
    let done = rig.finish().expect("it was in flight");
    let (_, whole) = rig.picture(&scene);
    assert_eq!(done.mean_transmittance, Some(whole.mean_transmittance));
    assert!(whole.mean_transmittance < 0.999, "control: there is shadow");
    let names = |stats: &FrameStats| stats.passes.iter().map(|pass| pass.name.clone()).collect::<Vec<_>>();
    // On a software adapter passes are measured by waiting for each.
    if rig.renderer.gpu().is_software() {
        assert_eq!(names(&stats)[..names(&stats).len() - 1], names(&whole)[..]);
        assert!(stats.traffic.waits > 0);
    }
}

#[test]
fn wrong_requests_are_refused_and_the_renderer_goes_on() {
    let Some(mut rig) = Rig::new() else { return };
    let scene = lit(Transparency::Sorted, ShadowMethod::VoxelMap);
    for size in [[0, 10], [10, 0], [20_000, 10]] {
        let refused = rig.renderer.image(&scene.input(), size, false, &mut rig.images);
        assert!(matches!(refused, Err(RenderError::Size(_))), "{size:?}");
    }
    let mut odd = lit(Transparency::Sorted, ShadowMethod::VoxelMap);
    odd.strands = Strands::default();
    let image = rig.settled(&odd).read().expect("pixels");
    assert!(image == rig.picture(&odd).0, "strands that the hairstyle lacks are left out in both");
    rig.settled(&scene);
}

#[test]
fn a_small_copy_is_the_mean_of_the_middle() {
    let Some(mut rig) = Rig::new() else { return };
    // Left half red, right half blue; the upper and lower edge, which are cut, green.
    let (width, height) = (128_u32, 128);
    let pixel = |i: u32| match (i % width, i / width) {
        (_, y) if !(28..100).contains(&y) => [0, 255, 0, 255],
        (x, _) if x < 64 => [200, 0, 0, 255],
        _ => [0, 0, 100, 255],
    };
    let picture = Picture { width, height, rgba: (0..width * height).flat_map(pixel).collect() };
    let image = rig.images.upload(&picture);
    assert!(image.read().expect("pixels") == picture, "what was uploaded comes back");
    let mut shrinker = Shrinker::new(rig.renderer.gpu()).expect("a kernel");
    let small = shrinker.shrink(&image, [64, 36]).read().expect("pixels");
    assert_eq!((small.width, small.height), (64, 36));
    assert!(small.rgba.chunks_exact(4).all(|pixel| pixel[1] == 0), "the edges are cut");
    assert_eq!((small.rgba[0], small.rgba[4 * 63 + 2]), (200, 100));
}

#[test]
fn a_picture_that_was_begun_with_a_short_list_is_not_taken_for_whole() {
    let Some(mut rig) = Rig::new() else { return };
    let mut much = scene(&tuft(600));
    (much.picture.transparency, much.camera.eye.z, much.look.diameter) = (Transparency::Sorted, 0.4, 0.01);
    let begun =
        [0; 2].map(|_| rig.renderer.begin_picture(&much.input(), SIZE[0], SIZE[1]).expect("it begins"));
    let mut picture = Picture::default();
    for pending in begun {
        let finished = rig.renderer.finish_picture(pending, &mut picture).expect("no error");
        assert!(
            finished.is_none(),
            "both lists were too short, although the first has made the next ones longer"
        );
    }
    let pending = rig.renderer.begin_picture(&much.input(), SIZE[0], SIZE[1]).expect("it begins");
    assert!(rig.renderer.finish_picture(pending, &mut picture).expect("no error").is_some());
    assert!(picture == rig.picture(&much).0);
}

#[test]
fn pictures_that_are_begun_ahead_have_the_same_bytes() {
    let Some(mut rig) = Rig::new() else { return };
    let mut scene = lit(Transparency::Sorted, ShadowMethod::VoxelMap);
    rig.settled(&scene);
    let mut expected = Vec::new();
    let mut begun = std::collections::VecDeque::new();
    let mut found = Vec::new();
    let mut last = Picture::default();
    for step in 0..4 {
        sway(&mut scene, step);
        expected.push(rig.picture(&scene).0);
    }
    let mut scene = lit(Transparency::Sorted, ShadowMethod::VoxelMap);
    for step in 0..4 {
        sway(&mut scene, step);
        begun.push_back(rig.renderer.begin_picture(&scene.input(), SIZE[0], SIZE[1]).expect("it begins"));
        if begun.len() == 2 {
            let oldest = begun.pop_front().expect("two");
            rig.renderer.finish_picture(oldest, &mut last).expect("no error").expect("long lists");
            found.push(last.clone());
        }
    }
    for pending in begun {
        rig.renderer.finish_picture(pending, &mut last).expect("no error").expect("long lists");
        found.push(last.clone());
    }
    assert!(found == expected);
    assert!(found[0] != found[3], "control: the hair moves");
}
