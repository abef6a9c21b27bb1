//! A picture behind the figure, laid into the image: computed on the CPU for both backends, so that both show the same pixels.

mod resample;

use std::sync::Arc;

use glam::Vec3;
use lovelock_appearance::environment::BackdropPicture;
use lovelock_base::memory::list_bytes;
use lovelock_picture::PictureSettings;
use lovelock_picture::{BackgroundForm, PictureFit};

use crate::FrameInput;
use resample::Reduced;

/// Pixels that are tone-mapped together.
const GROUP: usize = 16;

/// The tone curve: linear light of pixels to sRGB-encoded values in place, and the exposure.
pub(crate) type Encode = fn(&mut [[f32; GROUP]; 3], f32);

/// What the pixels of a laid picture depend on.
#[derive(Clone, Debug)]
struct Source {
    picture: Arc<BackdropPicture>,
    size: [u32; 2],
    fit: PictureFit,
    stops: f32,
    blur: f32,
    exposure: f32,
    border: Vec3,
}

impl PartialEq for Source {
    fn eq(&self, other: &Self) -> bool {
        let settings = |of: &Self| (of.size, of.fit, of.stops, of.blur, of.exposure, of.border);
        Arc::ptr_eq(&self.picture, &other.picture) && settings(self) == settings(other)
    }
}

/// A picture behind the figure as an image shows it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LaidBackdrop {
    /// Width and height, pixels.
    pub(crate) size: [u32; 2],
    /// The colours that a screen shows, sRGB-encoded: red, green and blue of 10 bits each, from the lowest on. Row after row from the top.
    pub(crate) pixels: Vec<u32>,
    /// Changes with the pixels; 0 of none.
    pub(crate) number: u64,
}

impl LaidBackdrop {
    /// The colour of a pixel, sRGB-encoded; black outside.
    #[inline]
    pub(crate) fn color(&self, x: usize, y: usize) -> [f32; 3] {
        let [width, height] = self.size;
        let inside = x < width as usize && y < height as usize;
        let packed = if inside { self.pixels[y * width as usize + x] } else { 0 };
        [0, 10, 20].map(|shift| ((packed >> shift) & 1023) as f32 * (1.0 / 1023.0))
    }
}

/// Lays the picture of an image, and keeps it for the next ones.
#[derive(Debug, Default)]
pub(crate) struct Backdrop {
    of: Option<Source>,
    /// The picture, reduced to about the size of the image.
    copy: Option<(Arc<BackdropPicture>, Reduced)>,
    laid: Option<Arc<LaidBackdrop>>,
    number: u64,
}

impl Backdrop {
    /// The picture behind the figure in an image of `size`; `None` if it has none. `encode` is the tone curve of the image.
    pub fn follow(
        &mut self,
        input: &FrameInput,
        size: [u32; 2],
        encode: Encode,
    ) -> Option<Arc<LaidBackdrop>> {
        let shown = input.backdrop.filter(|_| input.picture.background == BackgroundForm::Picture);
        let Some(picture) = shown else {
            (self.of, self.copy, self.laid) = (None, None, None);
            return None;
        };
        self.lay(source(picture, input.picture, size), encode);
        self.laid.clone()
    }

    /// Lays a picture if anything has changed. The whole picture is read only for another one or a much larger or smaller image.
    fn lay(&mut self, of: Source, encode: Encode) {
        if self.of.as_ref() == Some(&of) {
            return;
        }
        let halvings = resample::halvings(&of);
        let is_of = |(picture, copy): &(Arc<BackdropPicture>, Reduced)| {
            Arc::ptr_eq(picture, &of.picture) && copy.halvings == halvings
        };
        let kept = self.copy.take().filter(is_of);
        let kept = kept.unwrap_or_else(|| (Arc::clone(&of.picture), Reduced::new(&of.picture, halvings)));
        let pixels = resample::lay(&of, &kept.1, encode);
        self.copy = Some(kept);
        self.number += 1;
        self.laid = Some(Arc::new(LaidBackdrop { size: of.size, pixels, number: self.number }));
        self.of = Some(of);
    }

    /// Memory that is kept, bytes.
    pub fn bytes(&self) -> u64 {
        let laid = self.laid.as_ref().map_or(0, |laid| list_bytes(&laid.pixels));
        laid + self.copy.as_ref().map_or(0, |(_, copy)| copy.bytes())
    }
}

fn source(picture: &Arc<BackdropPicture>, settings: &PictureSettings, size: [u32; 2]) -> Source {
    Source {
        picture: Arc::clone(picture),
        size,
        fit: settings.background_fit,
        stops: settings.background_stops,
        blur: settings.background_blur,
        exposure: settings.exposure_stops.exp2(),
        border: settings.background_top,
    }
}

/// sRGB-encoded to linear.
#[inline]
pub(crate) fn linear_of(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Linear to sRGB-encoded.
#[inline]
pub(crate) fn encoded_of(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.max(0.0).powf(1.0 / 2.4) - 0.055 }
}

/// What a screen shows of a colour that covers a part of a pixel, and of the picture behind it; both sRGB-encoded.
///
/// They are mixed as light that the screen emits. Were they mixed before tone mapping, a bright picture would outshine the figure in every
/// pixel that it shares with it, and its silhouette would be a jagged bright line.
#[inline]
pub(crate) fn mixed(over: [f32; 3], behind: [f32; 3], open: f32) -> [f32; 3] {
    if open >= 1.0 {
        return behind;
    }
    std::array::from_fn(|c| encoded_of(linear_of(over[c]) * (1.0 - open) + linear_of(behind[c]) * open))
}

#[cfg(test)]
mod tests;
