//! A picture for compositing: linear light with alpha, depth, and transmittance.

use std::sync::Arc;

use rayon::prelude::*;

use crate::{LaidBackdrop, Picture};

/// A picture before tone mapping. Rows from the top; one item per pixel in each list.
///
/// Values averaged over a pixel are linear, so that the mean of several pictures ([`Layers::add`]) is the image with an open
/// shutter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Red, green, blue and alpha: scene-linear light in the primaries of sRGB (Rec. 709), times the exposure
    /// ([`crate::PictureSettings::exposure_stops`]), before tone mapping and without an upper bound. Alpha is the fraction of the
    /// pixel that hair and body cover, and colour is multiplied by it. Over a background alpha is 1, but a picture behind the figure is not
    /// in the light: it is in `behind`, and shadows on it are in alpha, as black.
    pub light: Vec<[f32; 4]>,
    /// Distance along the camera's axis of the nearest surface in the pixel, metres: the body in any of the four samples, or a
    /// strand that covers at least [`Layers::LEAST_COVER`] of the pixel. [`Layers::NOTHING_METRES`] if there is none.
    pub depth: Vec<f32>,
    /// Transmittance of the first light that is switched on, averaged over the visible hair of the pixel, 0 to 1:
    /// `1 - Σ w (1 - T)`, where `w` is the visible fraction of a strand in the pixel and `T` its transmittance in steps of 1/255.
    /// It is 1 where there is no hair.
    pub transmittance: Vec<f32>,
    /// The picture behind the figure, which [`Layers::tone_map`] lays under the rest.
    pub behind: Option<Arc<LaidBackdrop>>,
}

impl Layers {
    /// The depth of empty pixels, metres: large as in Blender and not infinite, so that filters do not turn it into NaN.
    pub const NOTHING_METRES: f32 = 1e10;
    /// The least fraction of a pixel that a strand must cover to count for its depth: one step of 8 bits.
    pub const LEAST_COVER: f32 = 1.0 / 255.0;

    /// Resizes all lists.
    pub(crate) fn resize(&mut self, width: u32, height: u32) {
        let pixels = width as usize * height as usize;
        (self.width, self.height) = (width, height);
        self.light.resize(pixels, [0.0; 4]);
        self.depth.resize(pixels, Self::NOTHING_METRES);
        self.transmittance.resize(pixels, 1.0);
    }

    /// Starts a mean, with all values 0.
    pub fn clear_to(&mut self, width: u32, height: u32) {
        self.resize(width, height);
        self.light.fill([0.0; 4]);
        self.depth.fill(Self::NOTHING_METRES);
        self.transmittance.fill(0.0);
        self.behind = None;
    }

    /// Adds another picture of the same size with a weight. The weights should add up to 1. Depth becomes the nearest one.
    pub fn add(&mut self, other: &Self, weight: f32) {
        self.add_light(other, weight);
        self.add_values(other, weight);
    }

    /// As [`Layers::add`] for depth and transmittance alone.
    pub fn add_values(&mut self, other: &Self, weight: f32) {
        for (depth, other) in self.depth.iter_mut().zip(&other.depth) {
            *depth = depth.min(*other);
        }
        for (sum, transmittance) in self.transmittance.iter_mut().zip(&other.transmittance) {
            *sum += weight * transmittance;
        }
    }

    /// As [`Layers::add`] for the light alone.
    pub fn add_light(&mut self, other: &Self, weight: f32) {
        let light = self.light.par_iter_mut().zip(&other.light).with_min_len(4096);
        light.for_each(|(sum, light)| (0..4).for_each(|c| sum[c] += weight * light[c]));
        self.behind.clone_from(&other.behind);
    }

    /// The tone-mapped picture, with straight (not premultiplied) alpha. Over a background its bytes are those of the picture,
    /// except for rounding of the exposure.
    pub fn tone_map(&self, picture: &mut Picture) {
        (picture.width, picture.height) = (self.width, self.height);
        let row = self.width as usize;
        picture.rgba.resize(self.light.len() * 4, 0);
        let rows = picture.rgba.par_chunks_mut(4 * row.max(1)).zip(self.light.par_chunks(row.max(1)));
        rows.enumerate().for_each(|(y, (out, light))| match &self.behind {
            Some(behind) => crate::cpu::show_row_over(light, y as u32, behind, out),
            None => crate::cpu::show_row(light, y as u32, out),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(light: f32, alpha: f32, depth: f32) -> Layers {
        Layers {
            width: 2,
            height: 1,
            light: vec![[light, light, light, alpha]; 2],
            depth: vec![depth; 2],
            transmittance: vec![alpha; 2],
            behind: None,
        }
    }

    #[test]
    fn a_mean_is_that_of_light_and_the_depth_is_the_nearest() {
        let mut mean = Layers::default();
        mean.clear_to(2, 1);
        for (layers, weight) in [(grey(1.0, 1.0, 3.0), 0.25), (grey(0.2, 0.5, 2.0), 0.75)] {
            mean.add(&layers, weight);
        }
        assert!((mean.light[1][0] - 0.4).abs() < 1e-6 && (mean.light[0][3] - 0.625).abs() < 1e-6, "{mean:?}");
        assert_eq!(mean.depth, [2.0; 2]);
        assert!((mean.transmittance[0] - 0.625).abs() < 1e-6);
    }

    #[test]
    fn a_screen_shows_straight_alpha() {
        let show = |layers: &Layers| {
            let mut picture = Picture::default();
            layers.tone_map(&mut picture);
            picture.rgba
        };
        let (half, whole) = (show(&grey(0.1, 0.5, 1.0)), show(&grey(0.2, 1.0, 1.0)));
        assert_eq!((half[3], whole[3]), (128, 255));
        assert_eq!(half[..3], whole[..3], "the colour is that of what covers");
        assert_ne!(show(&grey(0.1, 1.0, 1.0))[..3], whole[..3], "the control");
        assert_eq!(show(&grey(0.0, 0.0, 1.0)), [0; 8], "nothing is black and clear");
    }
}
