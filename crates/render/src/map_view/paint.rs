//! Painting over a finished image.

use glam::{Mat4, Vec2, Vec3};
use lovelock_picture::MapValue;
use rayon::prelude::*;

use crate::camera::NEAR_METRES;
use crate::{Camera, Picture};

/// Opacity where there is neither hair nor shadow, as a fraction of that where there is.
const FAINTEST: f32 = 0.2;
/// Colours of values from 0 to 1, sRGB.
const COLORS: [[f32; 3]; 6] = [
    [0.05, 0.03, 0.16],
    [0.32, 0.07, 0.43],
    [0.66, 0.18, 0.38],
    [0.91, 0.38, 0.22],
    [0.98, 0.68, 0.23],
    [0.99, 0.98, 0.75],
];
/// Colour and opacity of lines.
const LINE: ([f32; 3], f32) = ([1.0, 1.0, 1.0], 0.35);

/// The colour at a place of the scale, 0 to 1, sRGB.
pub(super) fn color_at(place: f32) -> [f32; 3] {
    // NaN becomes 0.
    let along = if place > 0.0 { place.min(1.0) } else { 0.0 } * (COLORS.len() - 1) as f32;
    let first = (along as usize).min(COLORS.len() - 2);
    let part = along - first as f32;
    std::array::from_fn(|c| COLORS[first][c] + (COLORS[first + 1][c] - COLORS[first][c]) * part)
}

/// The opacity at a place of the scale.
pub(super) fn opacity_at(value: MapValue, place: f32, opacity: f32) -> f32 {
    let weight = if value == MapValue::Transmittance { 1.0 - place } else { place };
    opacity * (FAINTEST + (1.0 - FAINTEST) * weight.clamp(0.0, 1.0))
}

/// An image that is painted over.
pub(super) struct Canvas<'a> {
    picture: &'a mut Picture,
    camera: &'a Camera,
    clip_from_world: Mat4,
    /// Pixels that a metre covers at one metre.
    pixels_per_metre: f32,
}

impl<'a> Canvas<'a> {
    pub fn new(picture: &'a mut Picture, camera: &'a Camera) -> Self {
        let aspect = picture.width as f32 / picture.height.max(1) as f32;
        let pixels_per_metre = camera.pixels_per_metre_at_one_metre(picture.height);
        Self { clip_from_world: camera.clip_from_world(aspect), picture, camera, pixels_per_metre }
    }

    pub fn eye(&self) -> Vec3 {
        self.camera.eye
    }

    /// Pixels from the left and the top, and the distance in front of the eye; `None` behind it.
    fn place(&self, p: Vec3) -> Option<(Vec2, f32)> {
        let clip = self.clip_from_world * p.extend(1.0);
        let size = Vec2::new(self.picture.width as f32, self.picture.height as f32);
        let at = Vec2::new(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w) * size;
        // False for NaN.
        (clip.w > NEAR_METRES).then_some((at, clip.w))
    }

    /// The pixels in whose middle a plane is seen, and where it is there. `map_from_world` leads to the axes of the map, across one of
    /// which the plane is `at`; only what lies between both corners of the `extent` is seen.
    pub fn pixels_on_plane(
        &self,
        map_from_world: impl Fn(Vec3) -> Vec3 + Sync,
        axis: usize,
        at: f32,
        [min, max]: [Vec3; 2],
    ) -> Vec<(usize, Vec3)> {
        let (width, height) = (self.picture.width as usize, self.picture.height as usize);
        let world_from_clip = self.clip_from_world.inverse();
        let eye = map_from_world(self.camera.eye);
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let of_row = |y: usize| {
            let (map_from_world, others) = (&map_from_world, &others);
            (0..width).filter_map(move |x| {
                let ndc = Vec2::new(
                    (x as f32 + 0.5) / width as f32 * 2.0 - 1.0,
                    1.0 - (y as f32 + 0.5) / height as f32 * 2.0,
                );
                let toward = map_from_world(world_from_clip.project_point3(ndc.extend(0.5)));
                let way = (at - eye[axis]) / (toward[axis] - eye[axis]);
                let mut p = eye + (toward - eye) * way;
                p[axis] = at;
                let inside = others.iter().all(|&axis| p[axis] >= min[axis] && p[axis] <= max[axis]);
                // False for NaN, where the plane is seen from its edge.
                (way > 0.0 && way.is_finite() && inside).then_some((y * width + x, p))
            })
        };
        (0..height).into_par_iter().flat_map_iter(of_row).collect()
    }

    /// Blends a colour over a pixel.
    fn blend(&mut self, pixel: usize, color: [f32; 3], opacity: f32) {
        let Some(rgba) = self.picture.rgba.get_mut(4 * pixel..4 * pixel + 4) else { return };
        for (byte, color) in rgba.iter_mut().zip(color) {
            let below = f32::from(*byte);
            *byte = (below + (255.0 * color - below) * opacity + 0.5).clamp(0.0, 255.0) as u8;
        }
        let below = f32::from(rgba[3]);
        rgba[3] = (below + (255.0 - below) * opacity + 0.5).clamp(0.0, 255.0) as u8;
    }

    /// Paints a value on a pixel.
    pub fn put(&mut self, pixel: usize, value: MapValue, place: f32, opacity: f32) {
        self.blend(pixel, color_at(place), opacity_at(value, place, opacity));
    }

    /// Paints a value on a disc of `radius` metres around `p`.
    pub fn disc(&mut self, p: Vec3, radius: f32, value: MapValue, place: f32, opacity: f32) {
        let Some((at, w)) = self.place(p) else { return };
        let radius = (radius * self.pixels_per_metre / w).clamp(0.6, 64.0);
        let (width, height) = (self.picture.width as f32, self.picture.height as f32);
        let (low, high) = ((at - radius).floor().max(Vec2::ZERO), (at + radius).ceil());
        let high = high.min(Vec2::new(width, height));
        let (color, opacity) = (color_at(place), opacity_at(value, place, opacity));
        for y in low.y as u32..high.y as u32 {
            for x in low.x as u32..high.x as u32 {
                let distance = at.distance(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                let cover = (radius + 0.5 - distance).clamp(0.0, 1.0);
                if cover > 0.0 {
                    self.blend((y * self.picture.width + x) as usize, color, opacity * cover);
                }
            }
        }
    }

    /// Paints a thin line, unless one of its ends is behind the eye.
    pub fn line(&mut self, a: Vec3, b: Vec3) {
        let (Some((a, _)), Some((b, _))) = (self.place(a), self.place(b)) else { return };
        let length = (b - a).abs().max_element();
        // Far ends outside the image would make very long lines.
        if length.is_nan() || length >= 1e5 {
            return;
        }
        let steps = length.ceil().max(1.0) as usize;
        for step in 0..=steps {
            let p = a + (b - a) * (step as f32 / steps as f32);
            let inside = p.cmpge(Vec2::ZERO).all()
                && p.x < self.picture.width as f32
                && p.y < self.picture.height as f32;
            if inside {
                let pixel = p.y as usize * self.picture.width as usize + p.x as usize;
                self.blend(pixel, LINE.0, LINE.1);
            }
        }
    }
}
