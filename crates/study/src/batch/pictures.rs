//! Differences of images, and the images that others are compared with.

use lovelock_metrics::{Image, flip, psnr_db, ssim};
use lovelock_render::{Backend, Picture};

use crate::report::{FlipError, ImageDifference};

/// The reference image of each backend that draws, so that the differences between backends are no error of a method; and that of the
/// CPU.
#[derive(Debug, Default)]
pub(super) struct ReferencePictures(Vec<(Backend, Picture)>);

impl ReferencePictures {
    /// Adds that of a backend.
    pub(super) fn add(&mut self, backend: Backend, picture: Picture) {
        self.0.push((backend, picture));
    }

    /// The reference for images of a backend.
    pub(super) fn of(&self, backend: Backend) -> Option<&Picture> {
        self.0.iter().find(|(known, _)| *known == backend).map(|(_, picture)| picture)
    }

    /// The difference of the GPU's from the CPU's; `None` without both.
    ///
    /// # Errors
    /// If they have different sizes.
    pub(super) fn gpu_from_cpu(
        &self,
        hair: &[f32],
    ) -> Result<Option<ImageDifference>, lovelock_metrics::ImageError> {
        let (Some(gpu), Some(cpu)) = (self.of(Backend::Gpu), self.of(Backend::Cpu)) else { return Ok(None) };
        picture_error(gpu, cpu, hair).map(|(difference, _)| Some(difference))
    }
}

/// The difference of an image from the reference, and FLIP per pixel. `hair` is finite where a pixel shows hair.
///
/// # Errors
/// If the images have different sizes.
pub(super) fn picture_error(
    picture: &Picture,
    reference: &Picture,
    hair: &[f32],
) -> Result<(ImageDifference, Vec<f32>), lovelock_metrics::ImageError> {
    let test = Image::new(picture.width, picture.height, &picture.rgba)?;
    let reference = Image::new(reference.width, reference.height, &reference.rgba)?;
    let seen = flip(&reference, &test)?;
    let on_hair = seen.values.iter().zip(hair).filter(|(_, hair)| hair.is_finite());
    let (sum, count) =
        on_hair.fold((0.0, 0_u64), |(sum, count), (seen, _)| (sum + f64::from(*seen), count + 1));
    let hair_mean = (count > 0).then(|| sum / count as f64);
    let difference = ImageDifference {
        flip: FlipError { mean: seen.mean(), hair_mean, p99: seen.percentile(0.99) },
        psnr_db: Some(psnr_db(&reference, &test)?).filter(|db| db.is_finite()),
        // An image smaller than the SSIM window has no SSIM.
        ssim: ssim(&reference, &test).ok(),
    };
    Ok((difference, seen.values))
}
