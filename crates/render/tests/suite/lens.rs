//! Depth of field: the mean of images through an aperture.

use crate::common;

use common::{Scene, quad, scene};
use glam::{Vec2, Vec3};
use lovelock_render::{Backend, Layers};

const SIZE: u32 = 200;
const SAMPLES: u32 = 64;

/// A bright strip, `z` metres before the middle, in front of black.
fn strip(z: f32) -> Scene {
    let mut s = scene(&[]);
    s.body = Some(quad(z, 0.1, Vec3::splat(0.8)));
    s.picture.ambient = 4.0;
    s
}

/// The light of a row through an aperture of `radius` metres that is focused on the distance `focus`.
fn row(scene: &Scene, backend: Backend, (radius, focus): (f32, f32)) -> Option<Vec<f32>> {
    scene.with_renderer(backend, |renderer, input| {
        let (mut mean, mut one) = (Layers::default(), Layers::default());
        mean.clear_to(SIZE, SIZE);
        for i in 0..SAMPLES {
            // A spiral: even over the disc.
            let r = ((i as f32 + 0.5) / SAMPLES as f32).sqrt();
            let camera = input.camera.through(radius * r * Vec2::from_angle(2.399_963 * i as f32), focus);
            let input = lovelock_render::FrameInput { camera: &camera, ..*input };
            renderer.light(&input, SIZE, SIZE, false, &mut one).expect("light");
            mean.add_light(&one, 1.0 / SAMPLES as f32);
        }
        let row = (SIZE / 2 * SIZE) as usize;
        mean.light[row..row + SIZE as usize].iter().map(|pixel| pixel[3]).collect()
    })
}

/// The width of the ramp at the left edge of what covers a row: the number of pixels that are covered in part.
fn ramp(row: &[f32]) -> usize {
    row[..SIZE as usize / 2].iter().filter(|cover| (0.02..0.98).contains(*cover)).count()
}

#[test]
fn what_is_in_focus_stays_sharp_and_the_rest_spreads_by_its_circle_of_confusion() {
    let (radius, focus) = (0.06, 1.0);
    for backend in [Backend::Cpu, Backend::Gpu] {
        let sharp = strip(0.0);
        let Some(edge) = row(&sharp, backend, (radius, focus)) else { return };
        assert!(ramp(&edge) <= 2, "{backend}: {}", ramp(&edge));
        for z in [0.2_f32, -0.4] {
            let depth = 1.0 - z;
            let metres = 2.0 * radius * (depth - focus).abs() / depth;
            let pixels = metres / focus * sharp.camera.pixels_per_metre_at_one_metre(SIZE);
            let edge = row(&strip(z), backend, (radius, focus)).expect("as before");
            // Across a disc, 2 % to 98 % of the area is about 90 % of the diameter.
            let ramp = ramp(&edge) as f32;
            assert!((ramp - 0.9 * pixels).abs() <= 2.0, "{backend}, {depth} m: {ramp} of {pixels}");
        }
        // The control: a pinhole blurs nothing.
        let pinhole = row(&strip(0.2), backend, (0.0, focus)).expect("as before");
        assert!(self::ramp(&pinhole) <= 2, "{backend}");
    }
}
