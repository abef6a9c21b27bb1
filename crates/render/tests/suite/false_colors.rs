//! False colours on the device, compared with the values that the CPU draws.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_render::{
    ColorScale, CpuRenderer, DeviceImages, GpuRenderer, Picture, RenderError, ShadowMethod, StrandCount,
    Traffic, Transparency, ValueRenderer,
};

use crate::common::{Scene, grid, on_device, scene, tuft};

const SIZE: [u32; 2] = [160, 120];
const BEHIND: f32 = 0.3;

struct Rig {
    renderer: GpuRenderer,
    images: DeviceImages,
}

impl Rig {
    fn new() -> Option<Self> {
        let (renderer, images) = on_device()?;
        Some(Self { renderer, images })
    }

    /// The picture of a scene, and its false colours.
    fn colored(&mut self, scene: &Scene, values: &[f32], scale: &ColorScale) -> [Picture; 2] {
        let mut plain = Picture::default();
        self.renderer.picture(&scene.input(), SIZE[0], SIZE[1], &mut plain).expect("a picture");
        self.renderer.picture_on_device(&scene.input(), SIZE).expect("a picture");
        let image = self.renderer.false_colors(values, scale, &mut self.images).expect("false colours");
        [plain, image.read().expect("pixels")]
    }
}

/// Green rises, red falls, and blue is in no picture here.
fn scale(range: [f32; 2]) -> ColorScale {
    ColorScale {
        range,
        colors: std::array::from_fn(|k| [255 - k as u8, k as u8, 77]),
        behind: BEHIND,
        saturation: 0.0,
        relief: 0.0,
    }
}

/// The false colours of a picture, by the values of the CPU backend.
fn expected(scene: &Scene, values: &[f32], scale: &ColorScale, plain: &Picture) -> Vec<f32> {
    let mut front = Scene { style: Arc::clone(&scene.style), ..lit(Transparency::Sorted) };
    (front.strands, front.look) = (scene.strands.clone(), scene.look);
    let drawn = ValueRenderer::default().picture(&front.input(), values, SIZE[0], SIZE[1]).expect("values");
    let pixels = plain.rgba.chunks_exact(4).zip(&drawn.value).zip(&drawn.weight);
    let colors = pixels.flat_map(|((pixel, &value), &weight)| {
        let [r, g, b] = [pixel[0], pixel[1], pixel[2]].map(f32::from);
        let grey = scale.behind * (0.2126 * r + 0.7152 * g + 0.0722 * b);
        let place = ((value - scale.range[0]) / (scale.range[1] - scale.range[0])).clamp(0.0, 1.0) * 255.0;
        let share = if value.is_nan() { 0.0 } else { weight };
        let color = if value.is_nan() { [0.0; 3] } else { [255.0 - place, place, 77.0] };
        color.map(|color| (grey + share * (color - grey)).round())
    });
    colors.collect()
}

/// The mean difference of a colour, of 255, and the fraction of pixels that differ by more than 8.
fn off(found: &Picture, expected: &[f32]) -> (f64, f64) {
    let (mut sum, mut far) = (0.0, 0);
    for (pixel, expected) in found.rgba.chunks_exact(4).zip(expected.chunks_exact(3)) {
        let apart = [0, 1, 2].map(|c| (f64::from(pixel[c]) - f64::from(expected[c])).abs());
        sum += apart.iter().sum::<f64>() / 3.0;
        far += u32::from(apart.iter().any(|&apart| apart > 8.0));
    }
    let pixels = f64::from(found.width * found.height);
    (sum / pixels, f64::from(far) / pixels)
}

/// A tuft before a body.
fn lit(transparency: Transparency) -> Scene {
    let mut scene = scene(&tuft(200));
    scene.body = Some(grid(-0.1, 0.3, 8, Vec3::new(0.5, 0.3, 0.2)));
    (scene.picture.transparency, scene.picture.ground) = (transparency, true);
    scene.shadow.method = ShadowMethod::VoxelMap;
    scene.look.width_scale = 2.0;
    scene.camera.eye = Vec3::new(0.1, 0.1, 0.5);
    scene
}

/// Values from -0.2 to 0.2 that differ along and between strands.
fn waves(scene: &Scene) -> Vec<f32> {
    let Strands { x, y, .. } = &scene.strands;
    x.iter().zip(y).map(|(x, y)| 0.2 * (90.0 * x + 50.0 * y).sin()).collect()
}

#[test]
fn the_device_paints_the_values_that_the_cpu_draws() {
    let Some(mut rig) = Rig::new() else { return };
    for transparency in Transparency::ALL {
        let scene = lit(transparency);
        let mut values = waves(&scene);
        values[40..60].fill(f32::NAN);
        values[60..70].fill(f32::INFINITY);
        let scale = scale([-0.2, 0.2]);
        let [plain, found] = rig.colored(&scene, &values, &scale);
        let (mean, far) = off(&found, &expected(&scene, &values, &scale, &plain));
        let other: Vec<f32> = values.iter().map(|value| 0.9 * value).collect();
        let (control, _) = off(&found, &expected(&scene, &other, &scale, &plain));
        println!("{transparency}: {mean:.4}, {far:.5}; control {control:.4}");
        // Measured on a software adapter: 0.0031 and no pixel; values that are a tenth smaller give 0.288.
        assert!(mean < 0.02 && far < 1e-4, "{transparency}: {mean} {far}");
        assert!(control > 0.1, "{transparency}: {control}");
        assert!(found.rgba.chunks_exact(4).all(|pixel| pixel[3] == 255));
    }
}

#[test]
fn only_values_go_up_and_nothing_else_comes_back() {
    let Some(mut rig) = Rig::new() else { return };
    // A mode without lists of its own, so that the list is too short at first.
    let scene = lit(Transparency::WeightedAverage);
    let (values, scale) = (waves(&scene), scale([-0.2, 0.2]));
    let [_, first] = rig.colored(&scene, &values, &scale);
    let words = 4 * values.len() as u64;
    for round in 0..4 {
        let before = rig.renderer.gpu().traffic();
        let stats = rig.renderer.picture_on_device(&scene.input(), SIZE).expect("a picture");
        assert!(stats.traffic.bytes_back < 2048, "what the frame reports: {:?}", stats.traffic);
        let found = rig.renderer.transmittance(0).expect("transmittance");
        assert_eq!(found.len(), values.len());
        let asked = rig.renderer.gpu().traffic();
        assert_eq!(asked.since(before).bytes_back, stats.traffic.bytes_back + words);
        let image = rig.renderer.false_colors(&values, &scale, &mut rig.images).expect("false colours");
        let Traffic { bytes_up, bytes_back, waits, created } = rig.renderer.gpu().traffic().since(asked);
        assert_eq!((bytes_up, bytes_back, waits), (words, 8, 1), "round {round}");
        // The first rounds fill the buffers and bind groups that are kept.
        assert!(created == 0 || round < 2, "round {round}: {created}");
        assert!(image.read().expect("pixels") == first, "the same values, the same image");
    }
    // Control: a picture in memory is counted.
    let before = rig.renderer.gpu().traffic();
    rig.renderer.picture(&scene.input(), SIZE[0], SIZE[1], &mut Picture::default()).expect("a picture");
    assert!(rig.renderer.gpu().traffic().since(before).bytes_back > u64::from(4 * SIZE[0] * SIZE[1]));
}

#[test]
fn pictures_after_false_colours_are_unchanged() {
    let Some(mut rig) = Rig::new() else { return };
    let scene = lit(Transparency::Sorted);
    let scale = scale([-0.2, 0.2]);
    let [before, colored] = rig.colored(&scene, &waves(&scene), &scale);
    let [after, _] = rig.colored(&scene, &waves(&scene), &scale);
    assert!(before == after && before != colored);
}

#[test]
fn wrong_numbers_of_values_and_missing_pictures_are_refused() {
    let Some(mut rig) = Rig::new() else { return };
    let (scene, scale) = (lit(Transparency::Sorted), scale([0.0, 1.0]));
    let refused = rig.renderer.false_colors(&waves(&scene), &scale, &mut rig.images);
    assert!(matches!(refused, Err(RenderError::NoPicture)));
    rig.renderer.picture_on_device(&scene.input(), SIZE).expect("a picture");
    let refused = rig.renderer.false_colors(&[0.0; 3], &scale, &mut rig.images);
    assert!(matches!(refused, Err(RenderError::Known { found: 3, .. })));
    // Without hair there is the grey picture alone.
    let mut bald = lit(Transparency::Sorted);
    (bald.style, bald.strands) = (Arc::default(), Strands::default());
    let [plain, found] = rig.colored(&bald, &[], &scale);
    assert!(off(&found, &expected(&bald, &[], &scale, &plain)).1 == 0.0);
}

#[test]
fn both_backends_colour_strands_by_their_values() {
    let Some(mut rig) = Rig::new() else { return };
    for strands in [StrandCount::Stored, StrandCount::Fixed] {
        let mut scene = lit(Transparency::Sorted);
        (scene.picture.strands, scene.picture.strand_number) = (strands, 500.0);
        let count = scene.style.strands.count();
        let values: Vec<f32> = (0..count).map(|i| i as f32 / count as f32).collect();
        let scale = ColorScale { behind: 1.0, saturation: 1.0, relief: 0.4, ..scale([0.0, 1.0]) };
        let mut on_cpu = CpuRenderer::default();
        let [mut plain, mut again] = [Picture::default(), Picture::default()];
        on_cpu.picture(&scene.input(), SIZE[0], SIZE[1], &mut plain).expect("a picture");
        let mut drawn = |values: &[f32]| {
            let mut picture = Picture::default();
            on_cpu.strand_colors(&scene.input(), SIZE, (values, &scale), &mut picture).expect("colours");
            picture.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]].map(f32::from)).collect::<Vec<_>>()
        };
        let (expected, reversed) =
            (drawn(&values), values.iter().map(|value| 1.0 - value).collect::<Vec<_>>());
        let other = drawn(&reversed);
        let (image, _) = rig
            .renderer
            .strand_colors(&scene.input(), SIZE, (&values, &scale), &mut rig.images)
            .expect("colours");
        let found = image.read().expect("pixels");
        let ((mean, _), (control, _)) = (off(&found, &expected), off(&found, &other));
        println!("{strands:?}: {mean:.3}; control {control:.3}");
        assert!(mean < 0.8 && control > 4.0 * mean, "{strands:?}: {mean} {control}");
        // Where there is no hair the picture is as it was, and so is a later one.
        let bare = plain.rgba[..4] == [expected[0] as u8, expected[1] as u8, expected[2] as u8, 255];
        assert!(bare, "the corner has changed");
        on_cpu.picture(&scene.input(), SIZE[0], SIZE[1], &mut again).expect("a picture");
        assert!(again == plain);
    }
}
