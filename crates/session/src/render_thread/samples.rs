//! Further samples of an image that stands still, averaged in linear light.

use std::sync::Arc;

use glam::Vec2;
use lovelock_base::memory::list_bytes;
use lovelock_project::Project;
use lovelock_render::Picture;
use rayon::prelude::*;

use super::{ImageQuality, RenderRequest};
use crate::scene::radical;
use crate::snapshot::FrameSnapshot;

/// The most samples of each pixel.
const MAX: u32 = 16;

/// The most samples of an image with depth of field.
const MAX_OF_LENS: u32 = 48;

/// Where sample `index` is taken, pixels from the middle of a pixel: points of Halton's sequence. The places of a lens use its first two
/// bases.
pub(super) fn jitter(index: u32, of_lens: bool) -> Vec2 {
    let [a, b] = if of_lens { [5, 7] } else { [2, 3] };
    // The first sample is the middle of the pixel, as in an image of one sample.
    if index == 0 { Vec2::ZERO } else { Vec2::new(radical(index, a), radical(index, b)) - 0.5 }
}

/// The sums of the samples of one image.
#[derive(Debug, Default)]
pub(super) struct Samples {
    of: Option<(Arc<Project>, Arc<FrameSnapshot>, [u32; 2])>,
    taken: u32,
    /// Linear light in units of 1/65535, for each byte of the image.
    sums: Vec<u32>,
}

impl Samples {
    /// The memory of the sums, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.sums)
    }

    /// The number of samples so far.
    pub fn taken(&self) -> u32 {
        self.taken
    }

    /// Whether further samples of `request` are worth their time.
    pub fn wants_more(&self, request: &RenderRequest) -> bool {
        let most = if request.project.camera.lens.enabled { MAX_OF_LENS } else { MAX };
        request.quality == ImageQuality::Refined && self.is_of(request) && (1..most).contains(&self.taken)
    }

    fn is_of(&self, request: &RenderRequest) -> bool {
        self.of.as_ref().is_some_and(|(project, snapshot, size)| {
            Arc::ptr_eq(project, &request.project)
                && Arc::ptr_eq(snapshot, &request.snapshot)
                && *size == request.size
        })
    }

    /// Forgets all samples.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Adds sample `index` of an image, and replaces `picture` by the mean of all.
    pub fn add(&mut self, request: &RenderRequest, index: u32, picture: &mut Picture) {
        let linear = tables();
        if index == 0 || !self.is_of(request) || self.sums.len() != picture.rgba.len() {
            self.of = Some((Arc::clone(&request.project), Arc::clone(&request.snapshot), request.size));
            self.taken = 1;
            self.sums.clear();
            self.sums.par_extend(picture.rgba.par_iter().map(|&byte| linear.of_byte[usize::from(byte)]));
            return;
        }
        self.taken += 1;
        let count = self.taken;
        let add = |(sum, byte): (&mut u32, &mut u8)| {
            *sum += linear.of_byte[usize::from(*byte)];
            *byte = linear.byte(*sum / count);
        };
        self.sums.par_iter_mut().zip(&mut picture.rgba).with_min_len(1 << 14).for_each(add);
    }
}

/// Between bytes of sRGB and linear light.
struct Tables {
    of_byte: [u32; 256],
    /// The byte of each 16th value.
    bytes: Vec<u8>,
}

impl Tables {
    /// The byte that is nearest to a linear value of at most 65535.
    fn byte(&self, linear: u32) -> u8 {
        let near = self.bytes[(linear as usize >> 4).min(self.bytes.len() - 1)];
        // The table is off by one at most.
        let off = |byte: u8| self.of_byte[usize::from(byte)].abs_diff(linear);
        [near.saturating_sub(1), near, near.saturating_add(1)]
            .into_iter()
            .min_by_key(|&byte| off(byte))
            .unwrap_or(near)
    }
}

fn tables() -> &'static Tables {
    static TABLES: std::sync::OnceLock<Tables> = std::sync::OnceLock::new();
    TABLES.get_or_init(|| {
        let linear_of = |byte: usize| {
            let v = byte as f32 / 255.0;
            let linear = if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
            (linear * 65535.0).round() as u32
        };
        let of_byte: [u32; 256] = std::array::from_fn(linear_of);
        let nearest = |linear: u32| {
            let above = of_byte.partition_point(|&known| known < linear).min(255);
            let below = above.saturating_sub(1);
            let lower = of_byte[below].abs_diff(linear) < of_byte[above].abs_diff(linear);
            (if lower { below } else { above }) as u8
        };
        let bytes = (0..1 << 12).map(|step| nearest(step << 4)).collect();
        Tables { of_byte, bytes }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_back_and_means_are_those_of_light() {
        let tables = tables();
        for byte in 0..=255 {
            assert_eq!(tables.byte(tables.of_byte[usize::from(byte)]), byte);
        }
        // Half of white is byte 188, not 128.
        assert_eq!(tables.byte(65535 / 2), 188);
    }

    #[test]
    fn samples_fill_a_pixel_evenly() {
        let all: Vec<_> = (0..MAX).map(|index| jitter(index, false)).collect();
        assert_eq!(all[0], Vec2::ZERO);
        let mean = all.iter().sum::<Vec2>() / MAX as f32;
        assert!(mean.length() < 0.06, "{mean}");
        assert!(all.iter().all(|at| at.abs().max_element() <= 0.5));
        let quarters =
            |x: bool, y: bool| all.iter().filter(|at| (at.x >= 0.0, at.y >= 0.0) == (x, y)).count();
        for (x, y) in [(false, false), (false, true), (true, false), (true, true)] {
            assert!((3..=5).contains(&quarters(x, y)), "{}", quarters(x, y));
        }
    }
}
