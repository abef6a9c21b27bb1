//! Hair keeps its brightness and coverage with distance, on both backends and with every transparency.

use crate::common;

use std::sync::Arc;

use common::{Scene, scene, tuft};
use glam::Vec3;
use lovelock_render::{Backend, Camera, Picture, Transparency};

/// Sizes of the pictures, pixels along each edge.
const SIZES: [u32; 4] = [512, 128, 64, 32];

/// The tolerance of the relative change of light and coverage. Measured at most 0.018.
const BOUND: f64 = 0.03;

/// The same for coverage that is randomly rounded to samples. Measured at most 0.027.
const BY_CHANCE: f64 = 0.05;

/// The linear light of each grey value, found by rendering backgrounds of known light.
struct Screen(Vec<(f32, u8)>);

impl Screen {
    fn measured(backend: Backend) -> Option<Self> {
        let mut s = scene(&[]);
        let mut curve = Vec::new();
        for step in 0..160 {
            let light = (step as f32 / 159.0).powi(3) * 2.0;
            (s.picture.background_top, s.picture.background_bottom) =
                (Vec3::splat(light), Vec3::splat(light));
            let picture = s.draw_by(backend, 9, 9)?;
            curve.push((light, common::pixel(&picture, 4, 4)[1]));
        }
        Some(Self(curve))
    }

    fn light(&self, grey: u8) -> f32 {
        let at = self.0.partition_point(|&(_, g)| g < grey).clamp(1, self.0.len() - 1);
        let ((l0, g0), (l1, g1)) = (self.0[at - 1], self.0[at]);
        let part = (f32::from(grey) - f32::from(g0)) / (f32::from(g1) - f32::from(g0)).max(1.0);
        l0 + (l1 - l0) * part.clamp(0.0, 1.0)
    }

    /// The mean light of the picture.
    fn mean(&self, picture: &Picture) -> f64 {
        let sum: f64 = picture.rgba.chunks_exact(4).map(|p| f64::from(self.light(p[1]))).sum();
        sum / f64::from(picture.width * picture.height)
    }
}

/// A grey tuft in uniform light, completely visible in an image of `size` pixels.
fn grey_tuft(transparency: Transparency) -> Scene {
    let mut s = scene(&tuft(60));
    // Each strand has a hash of its own, with which opaque strands cover different samples of a pixel.
    let shades = &mut Arc::make_mut(&mut s.style).strands.shade;
    shades.iter_mut().enumerate().for_each(|(i, shade)| *shade = (i as f32 * 0.618_034).fract());
    (s.look.eumelanin, s.look.pheomelanin) = (0.05, 0.0);
    s.look.diameter = 0.0004;
    s.look.width_scale = 1.0;
    s.look.primary_strength = 0.0;
    s.look.secondary_strength = 0.0;
    s.lights.clear();
    s.picture.ambient = 1.0;
    s.picture.strand_opacity = 0.7;
    s.picture.transparency = transparency;
    s.camera =
        Camera { eye: Vec3::new(0.0, 0.0, 1.0), target: Vec3::ZERO, fov_y: 0.3, shear: glam::Vec2::ZERO };
    s
}

#[test]
fn light_and_cover_stay_as_a_tuft_recedes_long_suite() {
    for backend in [Backend::Cpu, Backend::Gpu] {
        let Some(screen) = Screen::measured(backend) else { return };
        for transparency in Transparency::ALL {
            let s = grey_tuft(transparency);
            let mut near = None;
            // The same view at lower and lower resolution: a hair is 0.7 pixels wide at 512, and 0.04 at 32.
            for size in SIZES {
                let hair = screen.mean(&s.draw_by(backend, size, size).expect("a picture"));
                // Coverage: the fraction of a light background that black hair hides.
                let mut dark = grey_tuft(transparency);
                dark.picture.ambient = 0.0;
                (dark.picture.background_top, dark.picture.background_bottom) =
                    (Vec3::splat(0.5), Vec3::splat(0.5));
                let covered = screen.mean(&dark.draw_by(backend, size, size).expect("a picture"));
                let mut empty = scene(&[]);
                (empty.picture, empty.camera) = (dark.picture, dark.camera);
                let hidden =
                    1.0 - covered / screen.mean(&empty.draw_by(backend, size, size).expect("a picture"));
                let (first, first_hidden) = *near.get_or_insert((hair, hidden));
                let (light, cover) = (hair / first - 1.0, hidden / first_hidden - 1.0);
                println!("{backend}, {transparency}, {size}: light {light:+.3}, cover {cover:+.3}");
                let bound = if transparency == Transparency::Opaque { BY_CHANCE } else { BOUND };
                assert!(light.abs() < bound && cover.abs() < bound, "{backend}, {transparency}, {size}");
            }
            // Control: hair with nine tenths of the width is detected.
            let mut thin = grey_tuft(transparency);
            thin.look.diameter *= 0.9;
            let thin = screen.mean(&thin.draw_by(backend, SIZES[1], SIZES[1]).expect("a picture"));
            let (first, _) = near.unwrap_or_default();
            assert!(1.0 - thin / first > BY_CHANCE, "{backend}, {transparency}: thin hair {}", thin / first);
        }
    }
}
